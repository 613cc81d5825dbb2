`include "widths.vh"
// A clip-space box, widened by a margin, against the edges of its node, along one axis. SPEC.md, 6.
module border_clip #(parameter W = `WORD_BITS) (
  input [W-1:0]   x_corner, w_corner, margin_corner,
  input [3*W-1:0] x_edge, w_edge, margin_edge,
  input           wider,
  output          outside, enclosed);
  wire [3*W-1:0] left_up, left_down, right_up, right_down;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire [W-1:0] at = x_edge[k*W +: W], by = margin_edge[k*W +: W];
      wire [W-1:0] to_right = at - w_edge[k*W +: W];
      assign left_up[k*W +: W]    = at + by;
      assign left_down[k*W +: W]  = at - by;
      assign right_up[k*W +: W]   = to_right + by;
      assign right_down[k*W +: W] = to_right - by;
    end
  endgenerate
  wire [W-1:0] to_right = x_corner - w_corner;
  wire signed [W-1:0] left_high, left_low, right_high, right_low, a, b, c, d;
  child_span #(W) of_left_up (.child_corner(x_corner + margin_corner),
    .child_edge(left_up), .low(a), .high(left_high));
  child_span #(W) of_left_down (.child_corner(x_corner - margin_corner),
    .child_edge(left_down), .low(left_low), .high(b));
  child_span #(W) of_right_up (.child_corner(to_right + margin_corner),
    .child_edge(right_up), .low(c), .high(right_high));
  child_span #(W) of_right_down (.child_corner(to_right - margin_corner),
    .child_edge(right_down), .low(right_low), .high(d));
  assign outside  = left_high < 0 | right_low > 0;
  assign enclosed = ~outside & (wider ? left_low > 0 & right_high < 0 : left_low >= 0 & right_high <= 0);
endmodule
