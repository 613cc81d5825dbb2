`include "widths.vh"
// Does a clip-space box leave a node by at most its width, on one axis? SPEC.md, 6.
module near_node #(parameter W = `WORD_BITS) (
  input [8*W-1:0] x, w,
  output          near);
  wire [7:0] beyond;
  genvar i;
  generate
    for (i = 0; i < 8; i = i + 1) begin : vertex
      wire signed [W-1:0] from_left = x[i*W +: W] + w[i*W +: W];
      wire signed [W-1:0] to_right  = x[i*W +: W] - (w[i*W +: W] << 1);
      assign beyond[i] = from_left < 0 | to_right > 0;
    end
  endgenerate
  assign near = ~|beyond;
endmodule
