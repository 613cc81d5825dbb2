`include "widths.vh"
`include "stage.vh"
// One coordinate of a clip-space cage relative to the node above: the exact inverse of half_clip.
module whole_clip #(parameter W = `WORD_BITS) (
  input  [`CAGE_WORDS*W-1:0] x, w,
  input                      right,
  output [`CAGE_WORDS*W-1:0] outer);
  genvar v;
  generate
    for (v = 0; v < `CAGE_WORDS; v = v + 1) begin : vertex
      wire signed [W-1:0] sum = x[v*W +: W] + (right ? w[v*W +: W] : {W{1'b0}});
      assign outer[v*W +: W] = sum >>> 1;
    end
  endgenerate
endmodule
