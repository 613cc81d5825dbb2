`include "widths.vh"
// Drawing rule `exact` for a record whose node was read: draw a solid, subdivide others. SPEC.md, 7.
module verdict #(parameter W = `WORD_BITS) (
  input                    leaf,
  input signed [W-1:0]     w_min,
  input                    has_lod_depth,
  input signed [W-1:0]     lod_depth,
  output                   solid);          // with level of detail
  wire deep;
  detail_depth #(W) detail (.w_min(w_min), .least(lod_depth), .solid(deep));
  assign solid = leaf | has_lod_depth & deep;
endmodule
