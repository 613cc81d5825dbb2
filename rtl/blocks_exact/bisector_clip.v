`include "widths.vh"
module bisector_clip #(parameter W = `WORD_BITS) (
  input [4*W-1:0]  x, w, margin,
  input            closed, sample,
  output [4*W-1:0] relative,
  output           low_half, high_half);
  wire [4*W-1:0] lower, raise;
  genvar k;
  generate
    for (k = 0; k < 4; k = k + 1) begin : number
      wire [W-1:0] beyond = (x[k*W +: W] << 1) - w[k*W +: W];
      wire [W-1:0] by = closed ? margin[k*W +: W] : {W{1'b0}};
      assign relative[k*W +: W] = beyond;
      assign lower[k*W +: W] = beyond - by;
      assign raise[k*W +: W] = beyond + by;
    end
  endgenerate
  wire signed [W-1:0] low, high, unused_high, unused_low;
  child_span #(W) lowered (.child(lower), .low(low), .high(unused_high));
  child_span #(W) raised  (.child(raise), .low(unused_low), .high(high));
  wire in_low  = closed ? low <= 0 : low < 0;
  wire in_high = closed ? high >= 0 : high > 0 | ~in_low;
  assign low_half  = sample ? in_low & in_high : in_low;
  assign high_half = sample ? in_low & in_high : in_high;
endmodule
