// Events of a stack with the way to parents, as frame_tb.v writes them down: of a parent the children that are left,
// the nearest lowest, its levels, and whether its box lies inside; then records in registers, new ones and those
// worked back.
if (dut.state == dut.POPPED) $fwrite(events, "0 %0d %h\n", dut.stacked,
  {nearest_lowest(dut.p_left), 6'd0 | dut.p_level, 6'd0 | dut.p_quad_level, dut.p_inside});
if (dut.state == dut.PUSH) $fwrite(events, "1 %0d %h\n", dut.stacked,
  {nearest_lowest(dut.left), dut.r_level, dut.r_quad_level, dut.r_inside});
if (dut.accepted) $fwrite(events, "7 0 %h %h\n",
  {1'b0, dut.inside_now, 1'b0, dut.c_level, dut.c_level, dut.c_quad_level, dut.c_node, dut.c_quad_x, dut.c_quad_y,
   dut.c_min, dut.c_max, dut.c_x, dut.c_y, dut.c_w, dut.c_w_min}, dut.c_more);
if (dut.worked_back) $fwrite(events, "7 1 %h %h\n",
  {1'b0, dut.r_inside, 1'b0, dut.r_level, dut.r_level, dut.r_quad_level, 32'd0, dut.r_quad_x, dut.r_quad_y,
   dut.r_min, dut.r_max, dut.r_x, dut.r_y, dut.r_w, {W{1'b0}}}, dut.r_more);
if (dut.fill_read & ~dut.known) $fwrite(events, "2 %0d\n", dut.elsewhere ?
  dut.fill_place(dut.word_level, dut.word_x, dut.word_y) : dut.fill_address);
if (dut.state == dut.MARK) $fwrite(events, "3 %0d %0h\n", dut.fill_address,
  dut.marks_word ? dut.written : {12'd0, dut.marked});
if (dut.state == dut.NODE) $fwrite(events, "4 %0d\n", dut.c_node);
if (dut.state == dut.ATTRIBUTE) $fwrite(events, "5 %0d\n", dut.c_node);
