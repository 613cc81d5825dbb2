`include "widths.vh"
// A screen-space box against a node's bisector, on one axis. SPEC.md, 6.
module bisector_screen #(parameter W = `WORD_BITS, F = `FRACTION_BITS) (
  input signed [W-1:0]     low, high,
  input [`PLACE_BITS-1:0]  node,
  input [`LEVEL_BITS-1:0]  below,
  output                   low_half, high_half);
  // In half widths of the node.
  wire [W-1:0] place = {node, 1'b1};
  wire signed [W-1:0] middle = place << below << (F - 1);
  assign low_half  = low < middle;
  assign high_half = middle < high | ~low_half;
endmodule
