// Searches a box for an undrawn sample, to draw it or to know that the record is visible. Stage B never does this
// (docs/rtl.md, Cycles); C searches an outline.
wire [3:0] found = overlapped & open;
wire [3:0] chosen_from = state == WALKED & c_quad_level != levels & |found ? found : waiting[4*back_level +: 4];
assign quadrant = state != WALKED & state != BACK ? only :
  chosen_from[0] ? 2'd0 : chosen_from[1] ? 2'd1 : chosen_from[2] ? 2'd2 : 2'd3;
wire [L-1:0] up = c_quad_level - back_level;
wire [CAGE-1:0] outer_x, outer_y;             // relative to the node above
whole_clip #(W) outer_of_x (.x(c_x), .w(c_w), .right(c_quad_x[0]), .outer(outer_x));
whole_clip #(W) outer_of_y (.x(c_y), .w(c_w), .right(c_quad_y[0]), .outer(outer_y));

task look_for_sample;
  begin
    waiting <= 0;
    c_quad_level <= r_quad_level;
    c_quad_x <= r_quad_x;
    c_quad_y <= r_quad_y;
    c_x <= r_x;
    c_y <= r_y;
    c_w <= r_w;
    c_more <= r_more;
    state <= WALK;
  end
endtask
