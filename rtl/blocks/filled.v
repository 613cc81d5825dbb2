`include "widths.vh"
// Is a quadtree node full? SPEC.md, 6.
module filled (
  input  [3:0] vector,
  output       full);
  assign full = &vector;
endmodule
