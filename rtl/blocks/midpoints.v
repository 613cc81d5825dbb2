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
  // Indices [i of 3][j, k of 2] and [i, j of 3][k of 2]. In one process, which Icarus Verilog simulates faster than wires.
  reg [12*W-1:0] along_x;
  reg [18*W-1:0] along_y;
  reg [27*W-1:0] all;
  integer i, k;
  always @* begin
    for (k = 0; k < 4; k = k + 1) begin
      along_x[k*W +: W]       = parent[(7 - k)*W +: W];
      along_x[(4 + k)*W +: W] = midpoint(parent[(7 - k)*W +: W], parent[(3 - k)*W +: W]);
      along_x[(8 + k)*W +: W] = parent[(3 - k)*W +: W];
    end
    for (i = 0; i < 3; i = i + 1)
      for (k = 0; k < 2; k = k + 1) begin
        along_y[(6*i + k)*W +: W]     = along_x[(4*i + k)*W +: W];
        along_y[(6*i + 2 + k)*W +: W] = midpoint(along_x[(4*i + k)*W +: W], along_x[(4*i + 2 + k)*W +: W]);
        along_y[(6*i + 4 + k)*W +: W] = along_x[(4*i + 2 + k)*W +: W];
      end
    for (i = 0; i < 9; i = i + 1) begin
      all[3*i*W +: W]       = along_y[2*i*W +: W];
      all[(3*i + 1)*W +: W] = midpoint(along_y[2*i*W +: W], along_y[(2*i + 1)*W +: W]);
      all[(3*i + 2)*W +: W] = along_y[(2*i + 1)*W +: W];
    end
  end
  assign pool = all;
endmodule
