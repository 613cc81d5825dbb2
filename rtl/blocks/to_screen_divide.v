`include "widths.vh"
// A divider alone, as in the vectors. The quotient follows `start` by 4 + fraction_bits cycles.
module to_screen_divide #(parameter W = `WORD_BITS) (
  input                    clk, start,
  input  [W-1:0]           x, w,
  input  [`LEVEL_BITS-1:0] fraction_bits,
  output                   last,
  output [W-1:0]           quotient);
  wire step, fraction;
  wire [1:0] place;
  divide_control control (.clk(clk), .start(start), .fraction_bits(fraction_bits), .step(step),
                          .place(place), .fraction(fraction), .last(last));
  divide_lane #(W) lane (.clk(clk), .load(start), .step(step), .place(place), .fraction(fraction),
                         .x(x), .w(w), .quotient(quotient));
endmodule
