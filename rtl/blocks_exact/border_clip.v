`include "widths.vh"
module border_clip #(parameter W = `WORD_BITS) (
  input [4*W-1:0] x, w, margin,
  input           wider,
  output          outside, enclosed);
  wire [4*W-1:0] left_up, left_down, right_up, right_down;
  genvar k;
  generate
    for (k = 0; k < 4; k = k + 1) begin : number
      wire [W-1:0] at = x[k*W +: W], by = margin[k*W +: W];
      wire [W-1:0] to_right = at - w[k*W +: W];
      assign left_up[k*W +: W]    = at + by;
      assign left_down[k*W +: W]  = at - by;
      assign right_up[k*W +: W]   = to_right + by;
      assign right_down[k*W +: W] = to_right - by;
    end
  endgenerate
  wire signed [W-1:0] left_high, left_low, right_high, right_low, a, b, c, d;
  child_span #(W) of_left_up    (.child(left_up), .low(a), .high(left_high));
  child_span #(W) of_left_down  (.child(left_down), .low(left_low), .high(b));
  child_span #(W) of_right_up   (.child(right_up), .low(c), .high(right_high));
  child_span #(W) of_right_down (.child(right_down), .low(right_low), .high(d));
  assign outside  = left_high < 0 | right_low > 0;
  assign enclosed = ~outside & (wider ? left_low > 0 & right_high < 0 : left_low >= 0 & right_high <= 0);
endmodule
