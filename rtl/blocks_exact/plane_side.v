`include "widths.vh"
// Side of a plane on which a node's samples lie: 0 both, 1 positive, 2 negative, 3 no plane. SPEC.md, 8.
// A sample counts by its middle, moved right by an infinitesimal and down by one infinitely smaller.
module plane_side #(parameter V = `WIDE_BITS) (
  input  [3*V-1:0] plane,
  input            sample,
  output [1:0]     side);
  wire signed [V-1:0] a = plane[2*V +: V], b = plane[V +: V], c = plane[0 +: V];
  wire signed [V-1:0] least    = (a & {V{a[V-1]}}) + (b & {V{b[V-1]}});
  wire signed [V-1:0] greatest = (a & {V{~a[V-1]}}) + (b & {V{~b[V-1]}});
  wire signed [V-1:0] low = c + least, high = c + greatest;
  wire signed [V-1:0] middle = (c << 1) + a + b;
  wire signed [V-1:0] decides = middle != 0 ? middle : a != 0 ? a : b;
  wire none = a == 0 & b == 0 & c == 0;
  wire [1:0] of_sample = decides < 0 ? 2'd2 : 2'd1;
  assign side = none ? 2'd3 : low >= 0 ? 2'd1 : high <= 0 ? 2'd2 : sample ? of_sample : 2'd0;
endmodule
