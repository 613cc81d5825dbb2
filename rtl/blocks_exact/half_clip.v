`include "widths.vh"
module half_clip #(parameter W = `WORD_BITS) (
  input  [4*W-1:0] x, far,
  input            right,
  output [4*W-1:0] inner);
  genvar k;
  generate
    for (k = 0; k < 4; k = k + 1) begin : number
      assign inner[k*W +: W] = right ? far[k*W +: W] : x[k*W +: W] << 1;
    end
  endgenerate
endmodule
