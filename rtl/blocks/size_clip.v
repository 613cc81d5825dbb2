`include "widths.vh"
// Is a clip-space record at most `most` large, on one axis? SPEC.md, 7.
// The sum of max(|x|, |x - w|) over its edges bounds its size.
module size_clip #(parameter W = `WORD_BITS) (
  input [3*W-1:0]      edge_x, edge_w,
  input signed [W-1:0] most,
  output               fits);
  function [W-1:0] magnitude(input [W-1:0] a);
    magnitude = a[W-1] ? -a : a;
  endfunction
  wire [3*W-1:0] greater;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire [W-1:0] here  = magnitude(edge_x[k*W +: W]);
      wire [W-1:0] there = magnitude(edge_x[k*W +: W] - edge_w[k*W +: W]);
      assign greater[k*W +: W] = here >= there ? here : there;
    end
  endgenerate
  wire signed [W-1:0] size = greater[0 +: W] + greater[W +: W] + greater[2*W +: W];
  assign fits = size <= most;
endmodule
