// States of a stack of children.
POPPED: begin
  r_solid <= p_solid;
  r_inside <= p_inside;
  r_level <= p_level;
  r_voxel_level <= p_voxel_level;
  r_quad_level <= p_quad_level;
  r_node <= p_node;
  r_quad_x <= p_quad_x;
  r_quad_y <= p_quad_y;
  r_min <= {corner_word(p_min_x), corner_word(p_min_y), corner_word(p_min_z)};
  r_max <= {corner_word(p_max_x), corner_word(p_max_y), corner_word(p_max_z)};
  r_x <= p_x;
  r_y <= p_y;
  r_w <= p_w;
  r_w_min <= p_w_min;
  r_more <= p_more;
  state <= FILLED;
end
NODE: if (node_taken) state <= VERDICT;
VERDICT: if (r_solid | node_ready) begin
  if (~r_solid) {mask, first} <= node_word[39:0];
  r_solid <= solid;
  judge;
end
ORDER: begin
  order <= order_now;
  state <= POOL;
end
POOL: begin
  pool_x <= pool_x_now;
  pool_y <= pool_y_now;
  pool_w <= pool_w_now;
  left <= there;
  state <= CHILD;
end
PUSH: begin
  stacked <= stacked + 1'b1;
  failed <= failed | stack_full;
  left <= left_after;
  state <= stack_full ? DONE : left_after != 0 ? CHILD : POP;
end
