`include "widths.vh"
// Quotient x / w + 4, one bit per cycle, for w > 0 and -4 w <= x < 12 w. SPEC.md, 5.
module divide_lane #(parameter W = `WORD_BITS) (
  input              clk, load, step,
  input      [1:0]   place,
  input              fraction,
  input      [W-1:0] x, w,
  output reg [W-1:0] quotient);
  reg  [W-1:0] remainder, divisor;
  wire [W-1:0] rest;
  wire         quotient_bit;
  divide_step #(W) one (.remainder(remainder), .divisor(divisor), .place(place), .fraction(fraction),
                        .rest(rest), .quotient_bit(quotient_bit));
  always @(posedge clk)
    if (load) begin
      remainder <= x + (w << 2);
      divisor   <= w;
      quotient  <= 0;
    end else if (step) begin
      remainder <= rest;
      quotient  <= {quotient[W-2:0], quotient_bit};
    end
endmodule
