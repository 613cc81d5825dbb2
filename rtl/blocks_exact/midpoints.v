`include "widths.vh"
// One coordinate of the pool: all children's corners, octant 0 highest, and their edges, halved towards zero. SPEC.md, 4.
module midpoints #(parameter W = `WORD_BITS) (
  input  [4*W-1:0]  parent,
  output [11*W-1:0] pool);
  wire [3*W-1:0] half;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire signed [W-1:0] edge_k = parent[k*W +: W];
      wire signed [W:0]   sum = edge_k + $signed({1'b0, edge_k[W-1]});
      assign half[k*W +: W] = sum[W:1];
    end
  endgenerate
  wire [W-1:0] x = half[2*W +: W], y = half[W +: W], z = half[0 +: W];
  wire [W-1:0] at_0 = parent[3*W +: W];
  wire [W-1:0] at_4 = at_0 + x, at_2 = at_0 + y, at_6 = at_4 + y;
  assign pool = {at_0, at_0 + z, at_2, at_2 + z, at_4, at_4 + z, at_6, at_6 + z, half};
endmodule
