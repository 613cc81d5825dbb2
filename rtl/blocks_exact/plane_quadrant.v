`include "widths.vh"
// The constant of a plane a x + b y + c in a quadrant's coordinates. SPEC.md, 8. Planes: a highest.
module plane_quadrant #(parameter V = `WIDE_BITS) (
  input  [3*V-1:0] plane,
  input  [1:0]     quadrant,
  output [V-1:0]   inner_c);
  wire [V-1:0] a = plane[2*V +: V], b = plane[V +: V], c = plane[0 +: V];
  assign inner_c = (c << 1) + (a & {V{quadrant[0]}}) + (b & {V{quadrant[1]}});
endmodule
