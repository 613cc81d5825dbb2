`include "widths.vh"
// The sample that holds a screen-space centre, clamped to its node, on one axis. SPEC.md, 7.
module centre_sample #(parameter W = `WORD_BITS, F = `FRACTION_BITS) (
  input signed [W-1:0]     centre,
  input [`PLACE_BITS-1:0]  node,
  input [`LEVEL_BITS-1:0]  below,
  output signed [W-1:0]    sample);
  wire [W-1:0] place = node;
  wire [W-1:0] next  = place + 1'b1;
  wire signed [W-1:0] first = place << below;
  wire signed [W-1:0] last  = (next << below) - 1'b1;
  wire signed [W-1:0] position = centre >>> F;
  wire signed [W-1:0] at_most = position <= last ? position : last;
  assign sample = at_most >= first ? at_most : first;
endmodule
