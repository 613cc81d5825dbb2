`include "widths.vh"
// One coordinate of all children, each a corner and three edges: edges halved towards zero, corners by
// seven adds. SPEC.md, 4. Edges: three words, along x highest.
module vertex_pool #(parameter W = `WORD_BITS) (
  input  [W-1:0]   parent_corner,
  input  [3*W-1:0] parent_edge,
  output [W-1:0]   child_000_corner, child_001_corner, child_010_corner, child_011_corner,
  output [W-1:0]   child_100_corner, child_101_corner, child_110_corner, child_111_corner,
  output [3*W-1:0] child_000_edge, child_001_edge, child_010_edge, child_011_edge,
  output [3*W-1:0] child_100_edge, child_101_edge, child_110_edge, child_111_edge);
  wire [3*W-1:0] half;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire signed [W-1:0] edge_k = parent_edge[k*W +: W];
      wire signed [W:0]   sum = edge_k + $signed({1'b0, edge_k[W-1]});
      assign half[k*W +: W] = sum[W:1];
    end
  endgenerate
  wire [W-1:0] x = half[2*W +: W], y = half[W +: W], z = half[0 +: W];
  assign child_000_corner = parent_corner;
  assign child_100_corner = child_000_corner + x;
  assign child_010_corner = child_000_corner + y;
  assign child_110_corner = child_100_corner + y;
  assign child_001_corner = child_000_corner + z;
  assign child_011_corner = child_010_corner + z;
  assign child_101_corner = child_100_corner + z;
  assign child_111_corner = child_110_corner + z;
  assign child_000_edge = half, child_001_edge = half, child_010_edge = half, child_011_edge = half;
  assign child_100_edge = half, child_101_edge = half, child_110_edge = half, child_111_edge = half;
endmodule
