`include "widths.vh"
// One coordinate of a child's eight vertices, from the pool.
module child_vertices #(parameter W = `WORD_BITS) (
  input  [27*W-1:0] pool,
  input  [2:0]      octant,
  output [8*W-1:0]  child);
  genvar v;
  generate
    for (v = 0; v < 8; v = v + 1) begin : vertex
      // Octant bits select along z, y, x.
      localparam AT = 9*(v/4) + 3*(v/2%2) + v%2;
      wire [4*W-1:0] z, y;
      genvar i;
      for (i = 0; i < 4; i = i + 1) begin : low
        localparam FROM = AT + 9*(i/2) + 3*(i%2);
        assign z[i*W +: W] = octant[0] ? pool[(FROM + 1)*W +: W] : pool[FROM*W +: W];
      end
      assign y[0 +: W] = octant[1] ? z[W +: W] : z[0 +: W];
      assign y[W +: W] = octant[1] ? z[3*W +: W] : z[2*W +: W];
      assign y[4*W-1:2*W] = {(2*W){1'b0}};
      assign child[(7 - v)*W +: W] = octant[2] ? y[W +: W] : y[0 +: W];
    end
  endgenerate
endmodule
