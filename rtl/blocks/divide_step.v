`include "widths.vh"
// One step of a restoring divide. Fraction steps double the remainder first, at place 0. SPEC.md, 5.
module divide_step #(parameter W = `WORD_BITS) (
  input  [W-1:0] remainder, divisor,
  input  [1:0]   place,
  input          fraction,
  output [W-1:0] rest,
  output         quotient_bit);
  wire [W+3:0] from  = fraction ? {3'd0, remainder, 1'b0} : {4'd0, remainder};
  wire [W+3:0] taken = {4'd0, divisor} << place;
  wire [W+4:0] left  = {1'b0, from} - {1'b0, taken};
  assign quotient_bit = ~left[W+4];
  assign rest = quotient_bit ? left[W-1:0] : from[W-1:0];
endmodule
