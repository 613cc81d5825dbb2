`include "widths.vh"
// A screen-space box against a node's edges, on one axis. SPEC.md, 6.
module border_screen #(parameter W = `WORD_BITS, F = `FRACTION_BITS) (
  input signed [W-1:0]     low, high,
  input [`PLACE_BITS-1:0]  node,
  input [`LEVEL_BITS-1:0]  below,
  output                   outside, enclosed);
  wire [W-1:0] place = node;
  wire [W-1:0] next  = place + 1'b1;
  wire signed [W-1:0] left  = place << below << F;
  wire signed [W-1:0] right = next << below << F;
  assign outside  = high < left | right < low;
  assign enclosed = ~outside & left <= low & high <= right;
endmodule
