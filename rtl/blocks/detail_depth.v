`include "widths.vh"
// Is a node deep enough for level of detail to draw it? SPEC.md, 7.
module detail_depth #(parameter W = `WORD_BITS) (
  input signed [W-1:0] w_min, least,
  output               solid);
  assign solid = w_min >= least;
endmodule
