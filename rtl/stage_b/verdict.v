`include "widths.vh"
// The drawing rule `exact`: a record whose node was read is drawn if it is a solid, else subdivided. SPEC.md, 7.
module verdict #(parameter W = `WORD_BITS) (
  input                    leaf,
  input [`LEVEL_BITS-1:0]  quad_level,
  input [4*W-1:0]          x, y, w,
  input signed [W-1:0]     w_min,
  input [`LEVEL_BITS-1:0]  levels,
  input                    has_lod_depth,
  input signed [W-1:0]     near, lod_depth,
  output                   solid,           // with level of detail
  output                   look_hidden);    // else subdivided only if an undrawn sample is found
  wire deep;
  wire [1:0] fits;
  wire signed [W-1:0] most;
  detail_depth #(W) detail (.w_min(w_min), .least(lod_depth), .solid(deep));
  size_limit #(W) sample_at_least_depth (.w_min(w_min), .below(levels - quad_level), .most(most));
  size_clip #(W) size_x (.edge_x(x[0 +: 3*W]), .edge_w(w[0 +: 3*W]), .most(most), .fits(fits[0]));
  size_clip #(W) size_y (.edge_x(y[0 +: 3*W]), .edge_w(w[0 +: 3*W]), .most(most), .fits(fits[1]));
  assign solid = leaf | has_lod_depth & deep;
  assign look_hidden = quad_level < levels & w_min >= near & &fits;
endmodule
