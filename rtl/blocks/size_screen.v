`include "widths.vh"
// Is a screen-space box at most `limit` large, on one axis? SPEC.md, 7.
module size_screen #(parameter W = `WORD_BITS) (
  input signed [W-1:0] low, high, limit,
  output               fits);
  wire signed [W-1:0] size = high - low;
  assign fits = size <= limit;
endmodule
