// Stage B: exact coverage with frame cages (`--coverage exact --cage frame`). What it has in machine.v: silhouette
// planes, and the samples that they cover. No record changes to screen space.
`include "children.vh"
`include "silhouettes.vh"

// The rest of an entry of the stack. No solid is pushed, so the voxel's level is the record's.
assign pushed_rest = {c_w, c_w_min, c_more};
assign {p_w, p_w_min, p_more} = popped_rest;
assign p_voxel_level = p_level;

// ---------------------------------------------------------------- the verdict
verdict #(W) rule (.leaf(leaf), .w_min(r_w_min), .has_lod_depth(has_lod_depth), .lod_depth(lod_depth), .solid(solid));
// There is no search for a hidden record: none that is subdivided is that small where the fit stops (docs/rtl.md, Cycles).
assign quadrant = only;

// Outlines are for drawing alone.
wire looks = 1'b0;
wire [5:0] turn_over = next_record;
task seen;
  state <= NODE;
endtask

// A record that is not full.
task take_up;
  state <= NODE;
endtask

// After its verdict.
task judge;
  state <= solid ? SOLID : CENTRE;
endtask
