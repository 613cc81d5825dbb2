`include "widths.vh"
// As in stage_a/. Only sample centres count. SPEC.md, 6.
module image_step #(parameter W = `WORD_BITS) (
  input [4*W-1:0]          x, y, w,
  input [`LEVEL_BITS-1:0]  below,
  input [1:0]              quadrant,          // y << 1 | x
  output                   outside, enclosed,
  output [3:0]             overlapped,
  output [4*W-1:0]         inner_x, inner_y,  // relative to the quadrant
  output                   near);             // leaves the quadrant by at most its width
  wire [4*W-1:0] no_margin = {(4*W){1'b0}};
  wire sample = below == 0;
  wire [4*W-1:0] far_x, far_y, gap;
  wire [1:0] out, in, near_each;
  wire [3:0] half;                            // y high, y low, x high, x low

  border_clip #(W) edge_x (.x(x), .w(w), .margin(no_margin), .wider(1'b0), .outside(out[0]), .enclosed(in[0]));
  border_clip #(W) edge_y (.x(y), .w(w), .margin(no_margin), .wider(1'b0), .outside(out[1]), .enclosed(in[1]));
  assign outside  = |out;
  assign enclosed = &in;

  margin_gap #(W) half_a_sample (.w(w), .below(below), .margin(gap));
  wire [4*W-1:0] margin = sample ? no_margin : gap;
  bisector_clip #(W) middle_x (.x(x), .w(w), .margin(margin), .closed(1'b1), .sample(sample),
    .relative(far_x), .low_half(half[0]), .high_half(half[1]));
  bisector_clip #(W) middle_y (.x(y), .w(w), .margin(margin), .closed(1'b1), .sample(sample),
    .relative(far_y), .low_half(half[2]), .high_half(half[3]));
  quadrants of_halves (.low_half_x(half[0]), .high_half_x(half[1]), .low_half_y(half[2]), .high_half_y(half[3]),
    .overlapped(overlapped));

  half_clip #(W) half_x (.x(x), .far(far_x), .right(quadrant[0]), .inner(inner_x));
  half_clip #(W) half_y (.x(y), .far(far_y), .right(quadrant[1]), .inner(inner_y));
  near_node #(W) near_x (.x(inner_x), .w(w), .near(near_each[0]));
  near_node #(W) near_y (.x(inner_y), .w(w), .near(near_each[1]));
  assign near = &near_each;
endmodule
