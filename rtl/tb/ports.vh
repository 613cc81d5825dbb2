// Events of `WALK, a machine, in one cycle. The stage adds those of its stack and fill vectors.
`include "events.vh"
if (`WALK.asked_node) $fwrite(events, "%0d 4 %0d\n", `TILE, `WALK.node_place);
if (`WALK.asked_attribute) $fwrite(events, "%0d 5 %0d\n", `TILE, `WALK.t_node);
if (`WALK.pixel & `WALK.pixel_taken) $fwrite(events, "%0d 6 %0d %0d\n", `TILE,
  `WALK.pixel_y * constants[5] + `WALK.pixel_x, `WALK.pixel_node);
