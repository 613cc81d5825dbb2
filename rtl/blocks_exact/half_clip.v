`include "widths.vh"
// One coordinate of a cage relative to a half of its node: 2 x in the near one, `far` (2 x - w) in the
// far one. SPEC.md, 4.
module half_clip #(parameter W = `WORD_BITS) (
  input  [W-1:0]   x_corner, far_corner,
  input  [3*W-1:0] x_edge, far_edge,
  input            right,
  output [W-1:0]   inner_corner,
  output [3*W-1:0] inner_edge);
  assign inner_corner = right ? far_corner : x_corner << 1;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      assign inner_edge[k*W +: W] = right ? far_edge[k*W +: W] : x_edge[k*W +: W] << 1;
    end
  endgenerate
endmodule
