`include "widths.vh"
// A cage's centre, one coordinate: the middle of its first and last vertex, rounded down. SPEC.md, 7.
module cage_centre #(parameter W = `WORD_BITS) (
  input [8*W-1:0] cage,
  output [W-1:0]  centre);
  wire signed [W-1:0] first = cage[7*W +: W];
  wire signed [W-1:0] last  = cage[0 +: W];
  wire signed [W:0]   sum   = first + last;
  assign centre = sum[W:1];
endmodule
