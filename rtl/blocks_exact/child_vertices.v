`include "widths.vh"
// One coordinate of a child's cage, from the pool.
module child_vertices #(parameter W = `WORD_BITS) (
  input  [11*W-1:0] pool,
  input  [2:0]      octant,
  output [4*W-1:0]  child);
  wire [4*W-1:0] z;
  wire [2*W-1:0] y;
  genvar i;
  generate
    for (i = 0; i < 4; i = i + 1) begin : along_z
      assign z[i*W +: W] = octant[0] ? pool[(3 + 2*i)*W +: W] : pool[(4 + 2*i)*W +: W];
    end
    for (i = 0; i < 2; i = i + 1) begin : along_y
      assign y[i*W +: W] = octant[1] ? z[2*i*W +: W] : z[(2*i + 1)*W +: W];
    end
  endgenerate
  assign child = {octant[2] ? y[0 +: W] : y[W +: W], pool[0 +: 3*W]};
endmodule
