`include "widths.vh"
// Adds two planes, or subtracts the second.
module plane_sum #(parameter V = `WIDE_BITS) (
  input  [3*V-1:0] plane, gain,
  input            less,
  output [3*V-1:0] sum);
  genvar i;
  generate
    for (i = 0; i < 3; i = i + 1) begin : number
      assign sum[i*V +: V] = less ? plane[i*V +: V] - gain[i*V +: V] : plane[i*V +: V] + gain[i*V +: V];
    end
  endgenerate
endmodule
