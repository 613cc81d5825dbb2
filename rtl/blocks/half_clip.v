`include "widths.vh"
// One coordinate of a cage relative to a half of its node; `far` is 2 x - w. SPEC.md, 4.
module half_clip #(parameter W = `WORD_BITS) (
  input  [8*W-1:0] x, far,
  input            right,
  output [8*W-1:0] inner);
  genvar i;
  generate
    for (i = 0; i < 8; i = i + 1) begin : vertex
      assign inner[i*W +: W] = right ? far[i*W +: W] : x[i*W +: W] << 1;
    end
  endgenerate
endmodule
