`include "widths.vh"
// Counts the steps of a divide: four integer steps, then one for each fraction bit.
// `start` loads the dividers; they step from the next cycle on, and `last` marks the last step.
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
