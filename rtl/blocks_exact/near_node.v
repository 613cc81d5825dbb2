`include "widths.vh"
module near_node #(parameter W = `WORD_BITS) (
  input [4*W-1:0] x, w,
  output          near);
  wire [4*W-1:0] from_left, to_right;
  genvar k;
  generate
    for (k = 0; k < 4; k = k + 1) begin : number
      assign from_left[k*W +: W] = x[k*W +: W] + w[k*W +: W];
      assign to_right[k*W +: W]  = x[k*W +: W] - (w[k*W +: W] << 1);
    end
  endgenerate
  wire signed [W-1:0] low, high, a, b;
  child_span #(W) left  (.child(from_left), .low(low), .high(a));
  child_span #(W) right (.child(to_right), .low(b), .high(high));
  assign near = low >= 0 & high <= 0;
endmodule
