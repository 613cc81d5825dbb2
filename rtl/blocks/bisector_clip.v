`include "widths.vh"
// A clip-space box against its node's bisector; `relative` is 2 x - w, in the far half. SPEC.md, 6.
module bisector_clip #(parameter W = `WORD_BITS) (
  input  [8*W-1:0] x, w, margin,
  input            closed, sample,
  output [8*W-1:0] relative,
  output           low_half, high_half);
  wire [7:0] in_low, in_high;
  genvar i;
  generate
    for (i = 0; i < 8; i = i + 1) begin : vertex
      wire signed [W-1:0] beyond = (x[i*W +: W] << 1) - w[i*W +: W];
      wire signed [W-1:0] by     = margin[i*W +: W];
      wire signed [W-1:0] lowered = beyond - by, raised = beyond + by;
      assign relative[i*W +: W] = beyond;
      assign in_low[i]  = closed ? lowered <= 0 : beyond < 0;
      assign in_high[i] = closed ? raised >= 0 : beyond > 0;
    end
  endgenerate
  wire low = |in_low, high = |in_high | ~closed & ~low;
  assign low_half  = sample ? low & high : low;
  assign high_half = sample ? low & high : high;
endmodule
