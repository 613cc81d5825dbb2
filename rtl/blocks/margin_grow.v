`include "widths.vh"
// A box's margin under a tolerance: w / 2^places per vertex, rounded up. SPEC.md, 6.
// Not in stage A, whose tolerance is infinite.
module margin_grow #(parameter W = `WORD_BITS) (
  input [8*W-1:0]    w,
  input signed [7:0] places,
  output [8*W-1:0]   margin);
  wire [7:0] up = -places;
  genvar i;
  generate
    for (i = 0; i < 8; i = i + 1) begin : vertex
      wire signed [W-1:0] wide = w[i*W +: W];
      wire signed [W-1:0] part = wide >>> places;
      assign margin[i*W +: W] = places > 0 ? part + 1'b1 : wide << up;
    end
  endgenerate
endmodule
