`include "children_steps.vh"
`include "search_steps.vh"
CHANGE: state <= changes ? DIVIDE : r_solid ? VERDICT : NODE;
DIVIDE: if (divided) state <= MOVE;
MOVE: begin
  r_x <= screen_x;
  r_y <= screen_y;
  r_w <= 0;
  r_w_min <= 0;
  r_more <= {1'b1, x_low, x_high, y_low, y_high};
  if (r_solid & untested) begin
    to_draw <= 1;
    look_for_sample;
    c_more <= {1'b1, x_low, x_high, y_low, y_high};
  end else
    state <= r_solid ? VERDICT : NODE;
end
MIDDLE: begin
  m_x <= mid_x;
  m_y <= mid_y;
  m_w <= mid_w;
  c_quad_level <= r_quad_level;
  c_quad_x <= r_quad_x;
  c_quad_y <= r_quad_y;
  state <= ~middle_shown ? next_record : r_quad_level == levels ? DRAW : HALVE;
end
HALVE: begin
  m_x <= half_x;
  m_y <= half_y;
  c_quad_level <= c_quad_level + 1'b1;
  c_quad_x <= {c_quad_x[P-2:0], right};
  c_quad_y <= {c_quad_y[P-2:0], lower};
  if (c_quad_level + 1'b1 == levels) state <= DRAW;
end
DRAW: state <= DRAWN;
