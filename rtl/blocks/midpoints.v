`include "widths.vh"
// One coordinate of the vertex pool: 3 x 3 x 3 vertices of eight children, the lowest word first, at 9 i + 3 j + k.
// Midpoints round down, so their order x, y, z matters. SPEC.md, 4.
module midpoints #(parameter W = `WORD_BITS) (
  input  [8*W-1:0]  parent,
  output [27*W-1:0] pool);
  function [W-1:0] midpoint(input signed [W-1:0] a, input signed [W-1:0] b);
    reg signed [W:0] sum;
    begin
      sum = a + b;
      midpoint = sum[W:1];
    end
  endfunction
  // Indices [i of 3][j, k of 2] and [i, j of 3][k of 2].
  wire [12*W-1:0] along_x;
  wire [18*W-1:0] along_y;
  genvar i, j, k;
  generate
    for (k = 0; k < 4; k = k + 1) begin : x
      wire [W-1:0] low  = parent[(7 - k)*W +: W];
      wire [W-1:0] high = parent[(3 - k)*W +: W];
      assign along_x[k*W +: W]       = low;
      assign along_x[(4 + k)*W +: W] = midpoint(low, high);
      assign along_x[(8 + k)*W +: W] = high;
    end
    for (i = 0; i < 3; i = i + 1) begin : y
      for (k = 0; k < 2; k = k + 1) begin : corner
        wire [W-1:0] low  = along_x[(4*i + k)*W +: W];
        wire [W-1:0] high = along_x[(4*i + 2 + k)*W +: W];
        assign along_y[(6*i + k)*W +: W]     = low;
        assign along_y[(6*i + 2 + k)*W +: W] = midpoint(low, high);
        assign along_y[(6*i + 4 + k)*W +: W] = high;
      end
    end
    for (i = 0; i < 9; i = i + 1) begin : z
      wire [W-1:0] low  = along_y[2*i*W +: W];
      wire [W-1:0] high = along_y[(2*i + 1)*W +: W];
      assign pool[3*i*W +: W]       = low;
      assign pool[(3*i + 1)*W +: W] = midpoint(low, high);
      assign pool[(3*i + 2)*W +: W] = high;
    end
  endgenerate
endmodule
