// Events of a stack of children and of its fill vectors.
if (`WALK.state == `WALK.POP) $fwrite(events, "%0d pop %0d 0\n", `TILE, `WALK.top);
if (`WALK.state == `WALK.PUSH) $fwrite(events, "%0d push %0d %0h\n", `TILE, `WALK.stacked,
  {`WALK.c_solid, `WALK.c_inside, `WALK.c_screen, `WALK.c_level, `WALK.c_voxel_level, `WALK.c_quad_level,
   `WALK.c_node, `WALK.c_quad_x, `WALK.c_quad_y, `WALK.c_min, `WALK.c_max, `WALK.c_x, `WALK.c_y, `WALK.c_w,
   `WALK.c_w_min, `FORM(`WALK.c_more)});
if (`WALK.fill_read) $fwrite(events, "%0d fill_read %0d 0\n", `TILE, place(`WALK.fill_level, `WALK.fill_x, `WALK.fill_y));
if (`WALK.state == `WALK.MARK) $fwrite(events, "%0d fill_write %0d %0h\n", `TILE,
  place(`WALK.fill_level, `WALK.fill_x, `WALK.fill_y), `WALK.marked);
