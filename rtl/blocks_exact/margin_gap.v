`include "widths.vh"
// What boxes are narrowed by: half a sample, of each number of the cage, negative. SPEC.md, 6.
module margin_gap #(parameter W = `WORD_BITS) (
  input signed [W-1:0]     w_corner,
  input [3*W-1:0]          w_edge,
  input [`LEVEL_BITS-1:0]  below,
  output [W-1:0]           margin_corner,
  output [3*W-1:0]         margin_edge);
  wire signed [W-1:0] corner = w_corner >>> below;
  assign margin_corner = -corner;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire signed [W-1:0] edge_k = w_edge[k*W +: W];
      wire signed [W-1:0] part = edge_k >>> below;
      assign margin_edge[k*W +: W] = -part;
    end
  endgenerate
endmodule
