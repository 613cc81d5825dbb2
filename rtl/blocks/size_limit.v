`include "widths.vh"
// Extent of a sample in clip space, `below` levels above the samples, for infinite tolerance. SPEC.md, 7.
module size_limit #(parameter W = `WORD_BITS) (
  input signed [W-1:0]     w_min,
  input [`LEVEL_BITS-1:0]  below,
  output signed [W-1:0]    most);
  assign most = w_min >>> below;
endmodule
