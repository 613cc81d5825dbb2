`include "widths.vh"
// A box against a picture node: edges, bisectors, and the box relative to each half. Boxes are relative to the node in clip
// space, to the picture in screen space. SPEC.md, 6.
module image_step #(parameter W = `WORD_BITS, F = `FRACTION_BITS) (
  input                    screen,
  input [8*W-1:0]          x, y, w,
  input [4*W-1:0]          spans,             // x low, x high, y low, y high
  input [`PLACE_BITS-1:0]  node_x, node_y,
  input [`LEVEL_BITS-1:0]  below,
  input [1:0]              quadrant,          // y << 1 | x
  output                   outside, enclosed,
  output [3:0]             overlapped,
  output [8*W-1:0]         inner_x, inner_y,  // relative to the quadrant, in clip space
  output                   near);             // leaves the quadrant by at most its width
  wire [8*W-1:0] no_margin = {(8*W){1'b0}};
  wire [8*W-1:0] far_x, far_y;
  wire [1:0] screen_out, screen_in, clip_out, clip_in, near_each;
  wire [3:0] screen_half, clip_half;          // y high, y low, x high, x low

  border_screen #(W, F) edge_sx (.low(spans[3*W +: W]), .high(spans[2*W +: W]), .node(node_x), .below(below),
    .outside(screen_out[0]), .enclosed(screen_in[0]));
  border_screen #(W, F) edge_sy (.low(spans[W +: W]), .high(spans[0 +: W]), .node(node_y), .below(below),
    .outside(screen_out[1]), .enclosed(screen_in[1]));
  border_clip #(W) edge_cx (.x(x), .w(w), .margin(no_margin), .wider(1'b0),
    .outside(clip_out[0]), .enclosed(clip_in[0]));
  border_clip #(W) edge_cy (.x(y), .w(w), .margin(no_margin), .wider(1'b0),
    .outside(clip_out[1]), .enclosed(clip_in[1]));
  assign outside  = screen ? |screen_out : |clip_out;
  assign enclosed = screen ? &screen_in : &clip_in;

  bisector_screen #(W, F) middle_sx (.low(spans[3*W +: W]), .high(spans[2*W +: W]), .node(node_x), .below(below),
    .low_half(screen_half[0]), .high_half(screen_half[1]));
  bisector_screen #(W, F) middle_sy (.low(spans[W +: W]), .high(spans[0 +: W]), .node(node_y), .below(below),
    .low_half(screen_half[2]), .high_half(screen_half[3]));
  bisector_clip #(W) middle_cx (.x(x), .w(w), .margin(no_margin), .closed(1'b0), .sample(1'b0),
    .relative(far_x), .low_half(clip_half[0]), .high_half(clip_half[1]));
  bisector_clip #(W) middle_cy (.x(y), .w(w), .margin(no_margin), .closed(1'b0), .sample(1'b0),
    .relative(far_y), .low_half(clip_half[2]), .high_half(clip_half[3]));
  wire [3:0] half = screen ? screen_half : clip_half;
  quadrants of_halves (.low_half_x(half[0]), .high_half_x(half[1]), .low_half_y(half[2]), .high_half_y(half[3]),
    .overlapped(overlapped));

  half_clip #(W) half_x (.x(x), .far(far_x), .right(quadrant[0]), .inner(inner_x));
  half_clip #(W) half_y (.x(y), .far(far_y), .right(quadrant[1]), .inner(inner_y));
  near_node #(W) near_x (.x(inner_x), .w(w), .near(near_each[0]));
  near_node #(W) near_y (.x(inner_y), .w(w), .near(near_each[1]));
  assign near = &near_each;
endmodule
