`include "widths.vh"
// A clip-space box, widened by a margin, against its node's edges, on one axis. SPEC.md, 6.
module border_clip #(parameter W = `WORD_BITS) (
  input [8*W-1:0] x, w, margin,
  input           wider,
  output          outside, enclosed);
  wire [7:0] left_of_left, right_of_right, within_left, within_right;
  genvar i;
  generate
    for (i = 0; i < 8; i = i + 1) begin : vertex
      wire signed [W-1:0] at       = x[i*W +: W];
      wire signed [W-1:0] by       = margin[i*W +: W];
      wire signed [W-1:0] to_right = at - $signed(w[i*W +: W]);
      wire signed [W-1:0] left_high = at + by, left_low = at - by;
      wire signed [W-1:0] right_high = to_right + by, right_low = to_right - by;
      assign left_of_left[i]   = left_high < 0;
      assign right_of_right[i] = right_low > 0;
      assign within_left[i]    = wider ? left_low > 0 : left_low >= 0;
      assign within_right[i]   = wider ? right_high < 0 : right_high <= 0;
    end
  endgenerate
  assign outside  = &left_of_left | &right_of_right;
  assign enclosed = ~outside & &within_left & &within_right;
endmodule
