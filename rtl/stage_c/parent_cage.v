`include "widths.vh"
// One coordinate of a parent's cage: the inverse of grown_cage.
module parent_cage #(parameter W = `WORD_BITS) (
  input  [4*W-1:0] child,
  input  [2:0]     octant,
  output [4*W-1:0] parent);
  wire [3*W-1:0] moved;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      assign moved[k*W +: W] = child[k*W +: W] & {W{octant[k]}};
      assign parent[k*W +: W] = child[k*W +: W] << 1;
    end
  endgenerate
  assign parent[3*W +: W] = child[3*W +: W] - moved[2*W +: W] - moved[W +: W] - moved[0 +: W];
endmodule
