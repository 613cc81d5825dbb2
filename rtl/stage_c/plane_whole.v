`include "widths.vh"
// A plane's constant in the coordinates of the node above: the inverse of plane_quadrant. Planes: a highest.
module plane_whole #(parameter V = `WIDE_BITS) (
  input  [3*V-1:0] plane,
  input  [1:0]     quadrant,
  output [V-1:0]   outer_c);
  wire [V-1:0] a = plane[2*V +: V], b = plane[V +: V], c = plane[0 +: V];
  wire signed [V-1:0] doubled = c - (a & {V{quadrant[0]}}) - (b & {V{quadrant[1]}});
  assign outer_c = doubled >>> 1;
endmodule
