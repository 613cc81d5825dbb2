`include "widths.vh"
// One coordinate of all children's cages, wired from the pool. SPEC.md, 4.
module vertex_pool #(parameter W = `WORD_BITS) (
  input  [4*W-1:0] parent,
  output [4*W-1:0] child_000, child_001, child_010, child_011,
  output [4*W-1:0] child_100, child_101, child_110, child_111);
  wire [11*W-1:0] pool;
  midpoints #(W) all (.parent(parent), .pool(pool));
  child_vertices #(W) of_000 (.pool(pool), .octant(3'd0), .child(child_000));
  child_vertices #(W) of_001 (.pool(pool), .octant(3'd1), .child(child_001));
  child_vertices #(W) of_010 (.pool(pool), .octant(3'd2), .child(child_010));
  child_vertices #(W) of_011 (.pool(pool), .octant(3'd3), .child(child_011));
  child_vertices #(W) of_100 (.pool(pool), .octant(3'd4), .child(child_100));
  child_vertices #(W) of_101 (.pool(pool), .octant(3'd5), .child(child_101));
  child_vertices #(W) of_110 (.pool(pool), .octant(3'd6), .child(child_110));
  child_vertices #(W) of_111 (.pool(pool), .octant(3'd7), .child(child_111));
endmodule
