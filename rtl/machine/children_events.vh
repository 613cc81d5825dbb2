// Events of a stack of children, as frame_tb.v writes them down.
if (dut.state == dut.POP) $fwrite(events, "0 %0d\n", dut.top);
if (dut.state == dut.PUSH) $fwrite(events, "1 %0d %h %h\n", dut.stacked,
  {dut.c_solid, dut.c_inside, dut.c_screen, dut.c_level, dut.c_voxel_level, dut.c_quad_level, dut.c_node,
   dut.c_quad_x, dut.c_quad_y, dut.c_min, dut.c_max, dut.c_x, dut.c_y, dut.c_w, dut.c_w_min}, dut.c_more);
if (dut.fill_read) $fwrite(events, "2 %0d\n", dut.fill_address);
if (dut.state == dut.MARK) $fwrite(events, "3 %0d %h\n", dut.fill_address, dut.marked);
if (dut.state == dut.NODE) $fwrite(events, "4 %0d\n", dut.r_node);
if (dut.state == dut.ATTRIBUTE) $fwrite(events, "5 %0d\n", dut.r_node);
