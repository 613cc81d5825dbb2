`include "widths.vh"
// Is a node, by its depth, within the level of detail? SPEC.md, 7.
module detail_depth #(parameter W = `WORD_BITS) (
  input signed [W-1:0] w_min, least,
  output               solid);
  assign solid = w_min >= least;
endmodule
