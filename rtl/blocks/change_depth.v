`include "widths.vh"
// Is a record deep enough for screen space? SPEC.md, 5.
module change_depth #(parameter W = `WORD_BITS) (
  input signed [W-1:0] w_min, least,
  output               deep);
  assign deep = w_min >= least;
endmodule
