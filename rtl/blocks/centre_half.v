`include "widths.vh"
// The half of a node that holds a centre, and the centre relative to it. SPEC.md, 4.
module centre_half #(parameter W = `WORD_BITS) (
  input  signed [W-1:0] value, w,
  output                right,
  output signed [W-1:0] inner);
  wire signed [W-1:0] doubled = value <<< 1;
  wire signed [W-1:0] beyond  = doubled - w;
  assign right = beyond >= 0;
  assign inner = right ? beyond : doubled;
endmodule
