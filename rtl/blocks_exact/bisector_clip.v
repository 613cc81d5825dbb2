`include "widths.vh"
// A clip-space box against its node's bisector: x relative to the far half, 2 x - w, and the halves that
// the box overlaps. SPEC.md, 6.
module bisector_clip #(parameter W = `WORD_BITS) (
  input [W-1:0]    x_corner, w_corner, margin_corner,
  input [3*W-1:0]  x_edge, w_edge, margin_edge,
  input            closed, sample,
  output [W-1:0]   relative_corner,
  output [3*W-1:0] relative_edge,
  output           low_half, high_half);
  wire [3*W-1:0] lower_edge, raise_edge;
  assign relative_corner = (x_corner << 1) - w_corner;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire [W-1:0] beyond = (x_edge[k*W +: W] << 1) - w_edge[k*W +: W];
      wire [W-1:0] by = closed ? margin_edge[k*W +: W] : {W{1'b0}};
      assign relative_edge[k*W +: W] = beyond;
      assign lower_edge[k*W +: W] = beyond - by;
      assign raise_edge[k*W +: W] = beyond + by;
    end
  endgenerate
  wire [W-1:0] by = closed ? margin_corner : {W{1'b0}};
  wire signed [W-1:0] low, high, unused_high, unused_low;
  child_span #(W) lowered (.child_corner(relative_corner - by), .child_edge(lower_edge), .low(low), .high(unused_high));
  child_span #(W) raised  (.child_corner(relative_corner + by), .child_edge(raise_edge), .low(unused_low), .high(high));
  wire in_low  = closed ? low <= 0 : low < 0;
  wire in_high = closed ? high >= 0 : high > 0 | ~in_low;
  assign low_half  = sample ? in_low & in_high : in_low;
  assign high_half = sample ? in_low & in_high : in_high;
endmodule
