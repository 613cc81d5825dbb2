WALK: state <= WALKED;
WALKED:
  if (c_quad_level == levels & |open)
    state <= found_sample;
  else if (c_quad_level != levels & |found) begin
    waiting[4*c_quad_level +: 4] <= found & (found - 4'd1);
    go_to_quadrant(quadrant);
    state <= WALK;
  end else if (~back_any)
    state <= next_record;
  else if (c_screen) begin
    waiting[4*back_level +: 4] <= chosen_from & (chosen_from - 4'd1);
    c_quad_level <= back_level + 1'b1;
    c_quad_x <= {c_quad_x >> up, quadrant[0]};
    c_quad_y <= {c_quad_y >> up, quadrant[1]};
    state <= WALK;
  end else
    state <= BACK;
BACK:
  if (c_quad_level != back_level) begin
    c_x <= outer_x;
    c_y <= outer_y;
    c_quad_x <= c_quad_x >> 1;
    c_quad_y <= c_quad_y >> 1;
    c_quad_level <= c_quad_level - 1'b1;
  end else begin
    waiting[4*back_level +: 4] <= chosen_from & (chosen_from - 4'd1);
    go_to_quadrant(quadrant);
    state <= WALK;
  end
