// Writes down what `WALK, a machine, does in a cycle: the tile that it draws, the port, and what crosses it.
if (`WALK.state == `WALK.POP) $fwrite(events, "%0d 0 %0d\n", `TILE, `WALK.top);
if (`WALK.state == `WALK.PUSH) $fwrite(events, "%0d 1 %0d %h %h\n", `TILE, `WALK.stacked,
  {`WALK.c_solid, `WALK.c_inside, `WALK.c_screen, `WALK.c_level, `WALK.c_voxel_level, `WALK.c_quad_level,
   `WALK.c_node, `WALK.c_quad_x, `WALK.c_quad_y, `WALK.c_min, `WALK.c_max, `WALK.c_x, `WALK.c_y, `WALK.c_w,
   `WALK.c_w_min}, `WALK.c_more);
if (`WALK.fill_read) $fwrite(events, "%0d 2 %0d\n", `TILE,
  `WALK.of_record ? place(`WALK.r_quad_level, `WALK.r_quad_x, `WALK.r_quad_y)
  : `WALK.draw_read ? place(`WALK.draw_level, `WALK.draw_x, `WALK.draw_y)
  : place(`WALK.c_quad_level, `WALK.c_quad_x, `WALK.c_quad_y));
if (`WALK.state == `WALK.MARK) $fwrite(events, "%0d 3 %0d %h\n", `TILE,
  place(`WALK.c_quad_level, `WALK.c_quad_x, `WALK.c_quad_y), `WALK.marked);
if (`WALK.node_request & `WALK.node_taken) $fwrite(events, "%0d 4 %0d\n", `TILE, `WALK.r_node);
if (`WALK.attribute_request & `WALK.attribute_taken) $fwrite(events, "%0d 5 %0d\n", `TILE, `WALK.r_node);
if (`WALK.pixel & `WALK.pixel_taken) $fwrite(events, "%0d 6 %0d %0d\n", `TILE,
  `WALK.pixel_y * constants[5] + `WALK.pixel_x, `WALK.pixel_node);
