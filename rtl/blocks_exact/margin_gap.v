`include "widths.vh"
// A box's negative margin: half a sample per number of the cage. SPEC.md, 6.
module margin_gap #(parameter W = `WORD_BITS) (
  input [4*W-1:0]         w,
  input [`LEVEL_BITS-1:0] below,
  output [4*W-1:0]        margin);
  genvar k;
  generate
    for (k = 0; k < 4; k = k + 1) begin : number
      wire signed [W-1:0] wide = w[k*W +: W];
      wire signed [W-1:0] part = wide >>> below;
      assign margin[k*W +: W] = -part;
    end
  endgenerate
endmodule
