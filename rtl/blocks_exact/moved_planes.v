`include "widths.vh"
// Change of planes when a cube's edge moves 2^places along an axis: the plane across that axis, shifted. SPEC.md, 8.
// Planes: a, b, c, a highest.
module moved_planes #(parameter V = `WIDE_BITS) (
  input  [2*V-1:0]         axis_ab,
  input  [V-1:0]           axis_c,
  input  [`LEVEL_BITS-1:0] places,
  output [3*V-1:0]         gain);
  wire [3*V-1:0] across = {axis_ab, axis_c};
  genvar i;
  generate
    for (i = 0; i < 3; i = i + 1) begin : number
      assign gain[i*V +: V] = across[i*V +: V] << places;
    end
  endgenerate
endmodule
