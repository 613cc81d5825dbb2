// Octant of a centre as the eye sees it, and the children, nearest first: SPEC.md, section 9.
module octant_order (
  centre_x, centre_y, centre_z, eye_floor_x, eye_floor_y, eye_floor_z, octant,
  child_0, child_1, child_2, child_3, child_4, child_5, child_6, child_7);
  `include "parameters.vh"
  input signed [WORD_BITS-1:0] centre_x, centre_y, centre_z;
  input signed [WORD_BITS-1:0] eye_floor_x, eye_floor_y, eye_floor_z;
  output [2:0] octant, child_0, child_1, child_2, child_3, child_4, child_5, child_6, child_7;
  assign octant = {eye_floor_x < centre_x, eye_floor_y < centre_y, eye_floor_z < centre_z};
  assign child_0 = octant ^ 3'd7, child_1 = octant ^ 3'd6;
  assign child_2 = octant ^ 3'd5, child_3 = octant ^ 3'd3;
  assign child_4 = octant ^ 3'd4, child_5 = octant ^ 3'd2;
  assign child_6 = octant ^ 3'd1, child_7 = octant;
endmodule
