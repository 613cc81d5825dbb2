// States of stages B and C: a silhouette down the image quadtree. A search does not change the child's node.
SOLID: begin
  waiting <= 0;
  whole <= 0;
  s_level <= t_quad_level;
  s_x <= t_quad_x;
  s_y <= t_quad_y;
  state <= COVER;
end
QUADRANT: state <= COVER;
COVER: begin
  if (~looks) begin
    c_quad_level <= s_level;
    c_quad_x <= s_x;
    c_quad_y <= s_y;
  end
  if (coverage == 0) draw_on;
  else if (looked) divide_node;
  else if (~sample | looks) state <= COVERED;
  else state <= known ? ATTRIBUTE : DRAWN;
end
COVERED: divide_node;
CLIMB:
  if (divided - 1'b1 == back_level) begin
    next_quadrant;
    whole <= 0;
    state <= QUADRANT;
  end
