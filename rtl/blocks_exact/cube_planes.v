`include "widths.vh"
// Planes of a cube's twelve edges. Of four along j, 0 is given, 1 is moved by a side along k = j + 1, 2 along l = j + 2,
// 3 along both (mod 3). SPEC.md, 8.
module cube_planes #(parameter V = `WIDE_BITS) (
  input  [3*V-1:0]         edge_x, edge_y, edge_z,
  input  [2*V-1:0]         axis_x, axis_y, axis_z,
  input  [V-1:0]           axis_x_c, axis_y_c, axis_z_c,
  input  [`LEVEL_BITS-1:0] side,
  output [3*V-1:0]         plane_x0, plane_x1, plane_x2, plane_x3,
  output [3*V-1:0]         plane_y0, plane_y1, plane_y2, plane_y3,
  output [3*V-1:0]         plane_z0, plane_z1, plane_z2, plane_z3);
  wire [3*V-1:0] gain_x, gain_y, gain_z;
  moved_planes #(V) of_x (.axis_ab(axis_x), .axis_c(axis_x_c), .places(side), .gain(gain_x));
  moved_planes #(V) of_y (.axis_ab(axis_y), .axis_c(axis_y_c), .places(side), .gain(gain_y));
  moved_planes #(V) of_z (.axis_ab(axis_z), .axis_c(axis_z_c), .places(side), .gain(gain_z));
  assign plane_x0 = edge_x, plane_y0 = edge_y, plane_z0 = edge_z;
  plane_sum #(V) x1 (.plane(edge_x), .gain(gain_z), .less(1'b1), .sum(plane_x1));
  plane_sum #(V) x2 (.plane(edge_x), .gain(gain_y), .less(1'b0), .sum(plane_x2));
  plane_sum #(V) x3 (.plane(plane_x1), .gain(gain_y), .less(1'b0), .sum(plane_x3));
  plane_sum #(V) y1 (.plane(edge_y), .gain(gain_x), .less(1'b1), .sum(plane_y1));
  plane_sum #(V) y2 (.plane(edge_y), .gain(gain_z), .less(1'b0), .sum(plane_y2));
  plane_sum #(V) y3 (.plane(plane_y1), .gain(gain_z), .less(1'b0), .sum(plane_y3));
  plane_sum #(V) z1 (.plane(edge_z), .gain(gain_y), .less(1'b1), .sum(plane_z1));
  plane_sum #(V) z2 (.plane(edge_z), .gain(gain_x), .less(1'b0), .sum(plane_z2));
  plane_sum #(V) z3 (.plane(plane_z1), .gain(gain_x), .less(1'b0), .sum(plane_z3));
endmodule
