`include "widths.vh"
// One coordinate of a child's cage: halved edges, and the corner, moved by up to three of them. Halves are exact.
// SPEC.md, 4.
module grown_cage #(parameter W = `WORD_BITS) (
  input  [4*W-1:0] parent,
  input  [2:0]     octant,
  output [4*W-1:0] child);
  wire [3*W-1:0] half, moved;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire signed [W-1:0] edge_k = parent[k*W +: W];
      assign half[k*W +: W] = edge_k >>> 1;
      assign moved[k*W +: W] = half[k*W +: W] & {W{octant[k]}};
    end
  endgenerate
  assign child = {parent[3*W +: W] + moved[2*W +: W] + moved[W +: W] + moved[0 +: W], half};
endmodule
