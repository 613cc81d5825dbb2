`include "widths.vh"
// Extent that a clip-space record of one sample may have, `below` levels above the samples. SPEC.md, 7.
// The limit is one sample: without a finite tolerance nothing is taken off it.
module size_limit #(parameter W = `WORD_BITS) (
  input signed [W-1:0]     w_min,
  input [`LEVEL_BITS-1:0]  below,
  output signed [W-1:0]    most);
  assign most = w_min >>> below;
endmodule
