// Stage B (`--coverage exact --cage frame`): silhouette planes, and samples that they cover. No screen space.
`include "children.vh"
`include "silhouettes.vh"

// The rest of a stack entry.
assign pushed_rest = {c_w, c_w_min, c_more};
assign {p_w, p_w_min, p_more} = popped_rest;
assign p_voxel_level = p_level;

verdict #(W) rule (.leaf(leaf), .w_min(r_w_min), .has_lod_depth(has_lod_depth), .lod_depth(lod_depth), .solid(solid));
// No search for occluded records: one that is small enough is a voxel (docs/rtl.md, Cycles).
assign quadrant = only;

wire looks = 1'b0;
wire [5:0] turn_over = next_record;
task seen;
  state <= NODE;
endtask

task take_up;
  state <= NODE;
endtask

task judge;
  state <= solid ? SOLID : CENTRE;
endtask
