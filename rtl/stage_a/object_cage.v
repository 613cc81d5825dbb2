`include "widths.vh"
// One coordinate of the object's eight vertices, vertex 0 highest, from its lowest corner and edges.
module object_cage #(parameter W = `WORD_BITS) (
  input  [W-1:0]   corner,
  input  [3*W-1:0] edges,
  output [8*W-1:0] cage);
  wire [W-1:0] x = edges[2*W +: W], y = edges[W +: W], z = edges[0 +: W];
  wire [W-1:0] v4 = corner + x;
  wire [W-1:0] v2 = corner + y;
  wire [W-1:0] v6 = v4 + y;
  assign cage = {corner, corner + z, v2, v2 + z, v4, v4 + z, v6, v6 + z};
endmodule
