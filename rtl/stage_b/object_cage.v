`include "widths.vh"
// One coordinate of the object's cage: corner and edges from the host.
module object_cage #(parameter W = `WORD_BITS) (
  input  [W-1:0]   corner,
  input  [3*W-1:0] edges,
  output [4*W-1:0] cage);
  assign cage = {corner, edges};
endmodule
