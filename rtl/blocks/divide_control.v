`include "widths.vh"
// Counts a divide's steps: four integer steps, then one per fraction bit. They begin in the cycle after `start`.
module divide_control (
  input                    clk, start,
  input  [`LEVEL_BITS-1:0] fraction_bits,
  output reg               step,
  output [1:0]             place,
  output                   fraction, last);
  reg [`LEVEL_BITS:0] done;    // steps
  assign fraction = |done[`LEVEL_BITS:2];
  assign place = fraction ? 2'd0 : ~done[1:0];
  assign last = step & done == {1'b0, fraction_bits} + 7'd3;
  always @(posedge clk)
    if (start) begin
      step <= 1;
      done <= 0;
    end else if (step) begin
      step <= ~last;
      done <= done + 1'b1;
    end
  initial step = 0;
endmodule
