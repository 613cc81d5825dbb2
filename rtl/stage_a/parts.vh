// Stage A (`--paper`): the change to screen space, boxes there, and samples of boxes and centres.
`include "children.vh"
`include "search.vh"

// A record's screen-space flag and box: x low, x high, y low, y high.
wire             r_screen = r_more[4*W], c_screen = c_more[4*W];
wire [4*W-1:0]   r_spans = r_more[4*W-1:0], c_spans = c_more[4*W-1:0];
wire [MORE-1:0]  object_more = {MORE{1'b0}}, inner_more = c_more;
wire [MORE-1:0]  child_more = r_screen ? {1'b1, x_low, x_high, y_low, y_high} : {MORE{1'b0}};

// The rest of a stack entry. The box shares bits with w and w_min.
localparam VOXEL_LEVEL = $clog2(DEPTH + 1);
wire                   p_screen;
wire [VOXEL_LEVEL-1:0] p_voxel;
wire [9*W-1:0]         p_pose;
assign pushed_rest = {c_voxel_level[VOXEL_LEVEL-1:0], c_screen,
  c_screen ? {c_spans, {(5*W){1'b0}}} : {c_w, c_w_min}};
assign {p_voxel, p_screen, p_pose} = popped_rest;
assign p_voxel_level = p_voxel;
assign {p_w, p_w_min} = p_screen ? {(9*W){1'b0}} : p_pose;
assign p_more = p_screen ? {1'b1, p_pose[5*W +: 4*W]} : {MORE{1'b0}};

localparam CHANGE = 32, DIVIDE = 33, MOVE = 34, MIDDLE = 35, HALVE = 36, DRAW = 37;

// ---------------------------------------------------------------- change to screen space
wire deep, guarded;
wire [1:0] guard;
change_depth #(W) is_deep (.w_min(r_w_min), .least(near), .deep(deep));
// Four widths at the root. Below it, boxes leave their node by at most one.
change_guard #(W) guard_x (.x(r_x), .w(r_w), .places(-8'sd2), .enclosed(guard[0]));
change_guard #(W) guard_y (.x(r_y), .w(r_w), .places(-8'sd2), .enclosed(guard[1]));
assign guarded = r_inside | r_quad_level != 0 | &guard;
wire changes = deep & guarded;
wire divided;
wire [8*W-1:0] screen_x, screen_y;
to_screen #(W, F) change (.clk(clk), .start(state == CHANGE & changes), .x(r_x), .y(r_y), .w(r_w),
  .below(levels - r_quad_level), .node_x(r_quad_x), .node_y(r_quad_y), .last(divided),
  .screen_x(screen_x), .screen_y(screen_y));
wire signed [W-1:0] x_low, x_high, y_low, y_high;
child_span #(W) span_x (.child(state == MOVE ? screen_x : child_x), .low(x_low), .high(x_high));
child_span #(W) span_y (.child(state == MOVE ? screen_y : child_y), .low(y_low), .high(y_high));
wire behind = ~(state == CHILD & r_screen) & w_high < near;

image_step #(W, F) box (.screen(c_screen), .x(c_x), .y(c_y), .w(c_w), .spans(c_spans), .node_x(c_quad_x),
  .node_y(c_quad_y), .below(levels - c_quad_level), .quadrant(quadrant), .outside(box_outside_now),
  .enclosed(box_enclosed), .overlapped(overlapped), .inner_x(inner_x), .inner_y(inner_y), .near(box_near));

// A solid in screen space at the bound is drawn untested.
wire untested = r_level >= level_bound;
wire draw_box, draw_centre, subdivide, look_hidden;
verdict #(W) rule (.screen(r_screen), .solid_before(r_solid), .leaf(leaf), .in_node(r_inside), .level(r_level),
  .quad_level(r_quad_level), .x(r_x), .y(r_y), .w(r_w), .w_min(r_w_min), .spans(r_spans), .levels(levels),
  .level_bound(level_bound), .coarse(coarse), .has_lod_depth(has_lod_depth), .near(near),
  .near_crossing(near_crossing), .lod_depth(lod_depth), .size_limit(size_limit), .lod_limit(lod_limit),
  .least_size(least_size), .solid(solid), .draw_box(draw_box), .draw_centre(draw_centre),
  .subdivide(subdivide), .look_hidden(look_hidden));

// ---------------------------------------------------------------- the sample of a centre
reg  signed [W-1:0] m_x, m_y, m_w;
wire [W-1:0] middle_x, middle_y, middle_w;
cage_centre #(W) middle_of_x (.cage(r_x), .centre(middle_x));
cage_centre #(W) middle_of_y (.cage(r_y), .centre(middle_y));
cage_centre #(W) middle_of_w (.cage(r_w), .centre(middle_w));
wire signed [W-1:0] mid_x = middle_x, mid_y = middle_y, mid_w = middle_w;
wire middle_shown = mid_w >= near
  & (r_inside | mid_x >= 0 & mid_x < mid_w & mid_y >= 0 & mid_y < mid_w);
wire right, lower;
wire signed [W-1:0] half_x, half_y;
centre_half #(W) half_of_x (.value(m_x), .w(m_w), .right(right), .inner(half_x));
centre_half #(W) half_of_y (.value(m_y), .w(m_w), .right(lower), .inner(half_y));

reg to_draw;                                    // else the sample shows that the record is visible
wire [5:0] found_sample = to_draw ? DRAW : CENTRE;
wire draw_read = state == DRAW | state == WALK;
wire [L-1:0] draw_level = c_quad_level;
wire [P-1:0] draw_x = c_quad_x, draw_y = c_quad_y;

task take_up;
  begin
    to_draw <= r_screen & r_solid & untested;
    if (~r_screen) state <= CHANGE;
    else if (~r_solid) state <= NODE;
    else if (untested) look_for_sample;
    else state <= VERDICT;
  end
endtask

task judge;
  if (draw_box) begin
    to_draw <= 1;
    look_for_sample;
  end else if (draw_centre)
    state <= MIDDLE;
  else if (subdivide & look_hidden)
    look_for_sample;
  else
    state <= subdivide ? CENTRE : next_record;
endtask

task draw_on;
  if (to_draw) look_for_sample;
  else state <= next_record;
endtask
