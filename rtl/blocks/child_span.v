`include "widths.vh"
// Least and greatest of a cage's eight vertices, one coordinate: trees of three levels. SPEC.md, 4.
module child_span #(parameter W = `WORD_BITS) (
  input  [8*W-1:0]        child,
  output signed [W-1:0]   low, high);
  function [W-1:0] least(input signed [W-1:0] a, input signed [W-1:0] b);
    least = a <= b ? a : b;
  endfunction
  function [W-1:0] greatest(input signed [W-1:0] a, input signed [W-1:0] b);
    greatest = a >= b ? a : b;
  endfunction
  wire [4*W-1:0] least_of_2, greatest_of_2;
  wire [2*W-1:0] least_of_4, greatest_of_4;
  genvar i;
  generate
    for (i = 0; i < 4; i = i + 1) begin : two
      assign least_of_2[i*W +: W]    = least(child[2*i*W +: W], child[(2*i + 1)*W +: W]);
      assign greatest_of_2[i*W +: W] = greatest(child[2*i*W +: W], child[(2*i + 1)*W +: W]);
    end
    for (i = 0; i < 2; i = i + 1) begin : four
      assign least_of_4[i*W +: W]    = least(least_of_2[2*i*W +: W], least_of_2[(2*i + 1)*W +: W]);
      assign greatest_of_4[i*W +: W] = greatest(greatest_of_2[2*i*W +: W], greatest_of_2[(2*i + 1)*W +: W]);
    end
  endgenerate
  assign low  = least(least_of_4[0 +: W], least_of_4[W +: W]);
  assign high = greatest(greatest_of_4[0 +: W], greatest_of_4[W +: W]);
endmodule
