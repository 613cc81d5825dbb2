`include "widths.vh"
// Drawing rule `any` for a record whose node was read. SPEC.md, 7. At most one of draw_box, draw_centre and subdivide is
// set; without one, the record is dropped.
module verdict #(parameter W = `WORD_BITS) (
  input                    screen, solid_before, leaf, in_node,
  input [`LEVEL_BITS-1:0]  level, quad_level,
  input [8*W-1:0]          x, y, w,
  input signed [W-1:0]     w_min,
  input [4*W-1:0]          spans,           // x low, x high, y low, y high
  input [`LEVEL_BITS-1:0]  levels, level_bound,
  input                    coarse, has_lod_depth,
  input signed [W-1:0]     near, near_crossing, lod_depth,
  input signed [W-1:0]     size_limit, lod_limit, least_size,
  output                   solid,           // with level of detail
  output                   draw_box, draw_centre, subdivide,
  output                   look_hidden);    // subdivided only if an undrawn sample is found
  wire [W-1:0] x_low = spans[3*W +: W], x_high = spans[2*W +: W], y_low = spans[W +: W], y_high = spans[0 +: W];
  wire [1:0] fits_lod, fits_least, fits_sample, fits_clip;
  size_screen #(W) lod_x (.low(x_low), .high(x_high), .limit(lod_limit), .fits(fits_lod[0]));
  size_screen #(W) lod_y (.low(y_low), .high(y_high), .limit(lod_limit), .fits(fits_lod[1]));
  size_screen #(W) least_x (.low(x_low), .high(x_high), .limit(least_size), .fits(fits_least[0]));
  size_screen #(W) least_y (.low(y_low), .high(y_high), .limit(least_size), .fits(fits_least[1]));
  size_screen #(W) sample_x (.low(x_low), .high(x_high), .limit(size_limit), .fits(fits_sample[0]));
  size_screen #(W) sample_y (.low(y_low), .high(y_high), .limit(size_limit), .fits(fits_sample[1]));

  wire signed [W-1:0] w_low, w_high, most;
  child_span #(W) depths (.child(w), .low(w_low), .high(w_high));
  wire signed [W-1:0] spanned = w_high - w_low;
  wire before_near = ~screen & w_min < near;
  wire sliver = before_near & spanned < near_crossing;
  wire deep;
  detail_depth #(W) detail (.w_min(w_min), .least(lod_depth), .solid(deep));
  size_limit #(W) sample_at_least_depth (.w_min(w_min), .below(levels - quad_level), .most(most));
  function [3*W-1:0] edges_of(input [8*W-1:0] v);   // vertices 4, 2, 1 from vertex 0, the highest word
    edges_of = {v[3*W +: W] - v[7*W +: W], v[5*W +: W] - v[7*W +: W], v[6*W +: W] - v[7*W +: W]};
  endfunction
  size_clip #(W) clip_x (.edge_x(edges_of(x)), .edge_w(edges_of(w)), .most(most), .fits(fits_clip[0]));
  size_clip #(W) clip_y (.edge_x(edges_of(y)), .edge_w(edges_of(w)), .most(most), .fits(fits_clip[1]));

  assign solid = solid_before | leaf | (screen ? &fits_lod : has_lod_depth & deep);
  wire one   = quad_level == levels & in_node;
  wire bound = level >= level_bound | screen & &fits_least;
  wire now   = one & ~before_near & (solid | coarse);
  assign draw_box    = ~sliver & (now | bound & ~before_near);
  assign draw_centre = ~sliver & ~now & bound & before_near;
  assign subdivide   = ~sliver & ~now & ~bound;
  assign look_hidden = quad_level < levels & ~before_near & (screen ? &fits_sample : &fits_clip);
endmodule
