`include "silhouette_steps.vh"
VERDICT: begin
  draws <= deep;
  state <= SOLID;
end
NODE: if (node_taken) state <= READ;
READ: if (node_ready)
  if (reads_voxels) state <= NODE;
  else go_down;
PUSH: begin
  stacked <= stacked + 1'b1;
  failed <= failed | stack_full;
  become_parent;
  if (stack_full) state <= DONE;
end
POPPED: state <= FILLED;
OUT: begin
  r_x <= outer_x;
  r_y <= outer_y;
  r_more <= outer_more;
  r_quad_level <= r_quad_level - 1'b1;
  r_quad_x <= r_quad_x >> 1;
  r_quad_y <= r_quad_y >> 1;
  if (r_quad_level - 1'b1 == p_quad_level) state <= UP;
end
UP: begin
  r_x <= parent_x;
  r_y <= parent_y;
  r_w <= parent_w;
  r_more <= parent_more;
  r_min <= parent_min;
  r_max <= parent_max;
  r_level <= r_level - 1'b1;
  if (r_level - 1'b1 == p_level) state <= CENTRE;
end
ORDER: begin
  order <= order_now;
  state <= |(left & there) ? CHILD : next_record;
end
