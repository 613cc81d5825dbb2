`include "widths.vh"
// Is all of a quadtree node drawn? SPEC.md, 6.
module filled (
  input  [3:0] vector,
  output       full);
  assign full = &vector;
endmodule
