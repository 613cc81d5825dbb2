`include "widths.vh"
// A cube's centre in object space, with the sum's carry. SPEC.md, 2. Three words, x highest.
module centre #(parameter W = `WORD_BITS) (
  input  [3*W-1:0] min, max,
  output [3*W-1:0] centre);
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire signed [W-1:0] low  = min[k*W +: W];
      wire signed [W-1:0] high = max[k*W +: W];
      wire signed [W:0]   sum  = low + high;
      assign centre[k*W +: W] = sum[W:1];
    end
  endgenerate
endmodule
