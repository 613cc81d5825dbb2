`include "widths.vh"
// A child's lowest and highest corner in object space. SPEC.md, 1. Three words, x highest.
module child_corners #(parameter W = `WORD_BITS) (
  input  [3*W-1:0] min, max, centre,
  input  [2:0]     octant,
  output [3*W-1:0] child_min, child_max);
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      assign child_min[k*W +: W] = octant[k] ? centre[k*W +: W] : min[k*W +: W];
      assign child_max[k*W +: W] = octant[k] ? max[k*W +: W] : centre[k*W +: W];
    end
  endgenerate
endmodule
