`include "widths.vh"
// A child's silhouette planes. With k = j + 1 and l = j + 2 (mod 3), edge j loses the plane across l if the octant has
// bit k, and gains that across k if it has bit l, by half a side. SPEC.md, 8.
module child_planes #(parameter V = `WIDE_BITS) (
  input  [3*V-1:0]         edge_x, edge_y, edge_z,
  input  [2*V-1:0]         axis_x, axis_y, axis_z,
  input  [V-1:0]           axis_x_c, axis_y_c, axis_z_c,
  input  [`LEVEL_BITS-1:0] half,
  input  [2:0]             octant,
  output [3*V-1:0]         child_edge_x, child_edge_y, child_edge_z);
  wire [3*V-1:0] gain_x, gain_y, gain_z;
  moved_planes #(V) of_x (.axis_ab(axis_x), .axis_c(axis_x_c), .places(half), .gain(gain_x));
  moved_planes #(V) of_y (.axis_ab(axis_y), .axis_c(axis_y_c), .places(half), .gain(gain_y));
  moved_planes #(V) of_z (.axis_ab(axis_z), .axis_c(axis_z_c), .places(half), .gain(gain_z));
  wire [3*V-1:0] none = {(3*V){1'b0}};
  wire [3*V-1:0] first_x, first_y, first_z;
  plane_sum #(V) x_k (.plane(edge_x), .gain(octant[1] ? gain_z : none), .less(1'b1), .sum(first_x));
  plane_sum #(V) x_l (.plane(first_x), .gain(octant[0] ? gain_y : none), .less(1'b0), .sum(child_edge_x));
  plane_sum #(V) y_k (.plane(edge_y), .gain(octant[0] ? gain_x : none), .less(1'b1), .sum(first_y));
  plane_sum #(V) y_l (.plane(first_y), .gain(octant[2] ? gain_z : none), .less(1'b0), .sum(child_edge_y));
  plane_sum #(V) z_k (.plane(edge_z), .gain(octant[2] ? gain_y : none), .less(1'b1), .sum(first_z));
  plane_sum #(V) z_l (.plane(first_z), .gain(octant[1] ? gain_x : none), .less(1'b0), .sum(child_edge_z));
endmodule
