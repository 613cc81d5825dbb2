// Events of a stack of parents, of new and recomputed records, and of fill vectors.
if (`WALK.state == `WALK.POPPED) $fwrite(events, "%0d pop %0d %0h\n", `TILE, `WALK.stacked,
  {nearest_lowest(`WALK.p_left), 6'd0 | `WALK.p_level, 6'd0 | `WALK.p_quad_level, `WALK.p_inside});
if (`WALK.state == `WALK.PUSH) $fwrite(events, "%0d push %0d %0h\n", `TILE, `WALK.stacked,
  {nearest_lowest(`WALK.left), `WALK.r_level, `WALK.r_quad_level, `WALK.r_inside});
if (`WALK.accepted) $fwrite(events, "%0d made 0 %0h\n", `TILE,
  {1'b0, `WALK.inside_now, 1'b0, `WALK.c_level, `WALK.c_level, `WALK.c_quad_level, `WALK.c_node, `WALK.c_quad_x,
   `WALK.c_quad_y, `WALK.c_min, `WALK.c_max, `WALK.c_x, `WALK.c_y, `WALK.c_w, `WALK.c_w_min, `FORM(`WALK.c_more)});
if (`WALK.worked_back) $fwrite(events, "%0d made 1 %0h\n", `TILE,
  {1'b0, `WALK.r_inside, 1'b0, `WALK.r_level, `WALK.r_level, `WALK.r_quad_level, 32'd0, `WALK.r_quad_x,
   `WALK.r_quad_y, `WALK.r_min, `WALK.r_max, `WALK.r_x, `WALK.r_y, `WALK.r_w, {W{1'b0}}, `FORM(`WALK.r_more)});
if (`WALK.fill_read & ~`WALK.known) $fwrite(events, "%0d fill_read %0d 0\n", `TILE, `WALK.elsewhere ?
  place(`WALK.word_level, `WALK.word_x, `WALK.word_y) : place(`WALK.fill_level, `WALK.fill_x, `WALK.fill_y));
if (`WALK.state == `WALK.MARK) $fwrite(events, "%0d fill_write %0d %0h\n", `TILE,
  place(`WALK.fill_level, `WALK.fill_x, `WALK.fill_y), `WALK.marks_word ? `WALK.written : {12'd0, `WALK.marked});
