// Events of `WALK, a machine, in one cycle: tile, port, address, data in hexadecimal digits. The stage adds those of its stack
// and fill vectors.
`include "events.vh"
if (`WALK.asked_node) $fwrite(events, "%0d node_read %0d 0\n", `TILE, `WALK.node_place);
if (`WALK.asked_attribute) $fwrite(events, "%0d attribute_read %0d 0\n", `TILE, `WALK.t_node);
if (`WALK.pixel & `WALK.pixel_taken) $fwrite(events, "%0d pixel_write %0d %0h\n", `TILE,
  `WALK.pixel_y * constants[5] + `WALK.pixel_x, `WALK.pixel_node);
