`include "widths.vh"
// Sets bits of a fill vector. SPEC.md, 6.
module fill_update (
  input  [3:0] vector, bits,
  output [3:0] after,
  output       full);
  assign after = vector | bits;
  assign full  = &after;
endmodule
