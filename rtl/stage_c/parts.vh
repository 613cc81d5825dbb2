// Stage C. The subdivided record stays in registers. Its children are made one at a time, the nearest first. A child with an
// undrawn sample replaces its parent, which goes to the stack if it has children left. A pop computes the parent back.
`include "silhouettes.vh"
`include "joined_fill.vh"

// ---------------------------------------------------------------- the current record: a child
assign t_level = c_level, t_voxel_level = c_level, t_quad_level = c_quad_level, t_node = c_node;
assign t_quad_x = c_quad_x, t_quad_y = c_quad_y, t_min = c_min, t_max = c_max, t_w_min = c_w_min, t_more = c_more;
reg  c_leaf;                                    // no children
reg  [7:0] leaves;                              // of the parent
always @(posedge clk)
  if (state == OBJECT) c_leaf <= root_leaf | depth == 0;
  else if (state == CHILD) c_leaf <= r_level + 1'b1 >= depth | leaves[octant];
wire deep;
assign lod_look_up = state == OBJECT | state == CHILD, lod_level = state == OBJECT ? {L{1'b0}} : r_level + 1'b1;
detail_depth #(W) detail (.w_min(c_w_min), .least(lod_depth), .solid(deep));
reg  draws;
wire looks = ~draws;
wire [5:0] turn_over = |(left & there) ? CHILD : next_record;

localparam READ = 37, OUT = 38, UP = 39, LOOK = READ;

localparam LEVEL = $clog2(LEVEL_BOUND + 1), QUAD_LEVEL = $clog2(PICTURE_LEVELS + 1);
wire [NODE_WIDTH-1:0] p_first;
wire [LEVEL-1:0]      p_level;
wire [7:0]            p_left;
wire                  p_inside;
wire [QUAD_LEVEL-1:0] p_quad_level;
`include "bricks.vh"
localparam ENTRY = NODE_WIDTH + LEVEL + OF_NODE + 8 + 1 + QUAD_LEVEL;
wire [STACK_LOG2+CONTEXT_LOG2-1:0] entry = state == PUSH ? stacked[STACK_LOG2-1:0] : top;
memory #(.BITS(ENTRY), .WORDS(1 << (STACK_LOG2 + CONTEXT_LOG2)), .ADDRESS(STACK_LOG2 + CONTEXT_LOG2)) stack (.clk(clk),
  .read(state == POP), .write(state == PUSH & ~stack_full), .address(entry << CONTEXT_LOG2 | running),
  .data_in({first[NODE_WIDTH-1:0], r_level[LEVEL-1:0], r_of_node, left, r_inside, r_quad_level[QUAD_LEVEL-1:0]}),
  .data_out({p_first, p_level, p_of_node, p_left, p_inside, p_quad_level}));
wire [L-1:0] above = r_quad_level - p_quad_level;
assign asked_level = p_quad_level, asked_x = r_quad_x >> above, asked_y = r_quad_y >> above;

// ---------------------------------------------------------------- children, the nearest first
assign order_used = state == ORDER ? order_now : order;
wire [7:0] left_there = left & there;
integer place;
always @* begin
  octant = 0;
  left_after = 0;
  for (place = 0; place < 8; place = place + 1)
    if (left_there[place]) begin
      octant = order[3*place +: 3];
      left_after = left & ~(8'hff << place);
    end
end
assign any_left = |(left_after & there);
assign quadrant = only;
grown_cage #(W) grown_x (.parent(r_x), .octant(octant), .child(child_x));
grown_cage #(W) grown_y (.parent(r_y), .octant(octant), .child(child_y));
grown_cage #(W) grown_w (.parent(r_w), .octant(octant), .child(child_w));

// ---------------------------------------------------------------- back to the parent
wire [CAGE-1:0] outer_x, outer_y;
wire [MORE-1:0] outer_more;
whole_clip #(W) outer_of_x (.x(r_x), .w(r_w), .right(r_quad_x[0]), .outer(outer_x));
whole_clip #(W) outer_of_y (.x(r_y), .w(r_w), .right(r_quad_y[0]), .outer(outer_y));
generate
  for (e = 0; e < 3; e = e + 1) begin : out_of_quadrant
    assign outer_more[(3*e + 4)*V +: 2*V] = r_more[(3*e + 4)*V +: 2*V];
    plane_whole #(V) of_edge (.plane(r_more[(3*e + 3)*V +: 3*V]), .quadrant({r_quad_y[0], r_quad_x[0]}),
      .outer_c(outer_more[(3*e + 3)*V +: V]));
    plane_whole #(V) of_axis (.plane({axis_ab[2*e*V +: 2*V], r_more[e*V +: V]}),
      .quadrant({r_quad_y[0], r_quad_x[0]}), .outer_c(outer_more[e*V +: V]));
  end
endgenerate
// From a child to its parent. Bits of the lowest corner give the octant.
wire [L-1:0] octant_bit = depth + sub_levels - r_level;
wire [2:0]   in_parent = {r_min[2*W + octant_bit], r_min[W + octant_bit], r_min[octant_bit]};
wire [CAGE-1:0] parent_x, parent_y, parent_w;
wire [MORE-1:0] parent_more;
wire [3*W-1:0]  parent_min, parent_max;
parent_cage #(W) parent_of_x (.child(r_x), .octant(in_parent), .parent(parent_x));
parent_cage #(W) parent_of_y (.child(r_y), .octant(in_parent), .parent(parent_y));
parent_cage #(W) parent_of_w (.child(r_w), .octant(in_parent), .parent(parent_w));
parent_planes #(V) parent_of_planes (.edge_x(r_more[9*V +: 3*V]), .edge_y(r_more[6*V +: 3*V]),
  .edge_z(r_more[3*V +: 3*V]), .axis_x(axis_ab[4*V +: 2*V]), .axis_y(axis_ab[2*V +: 2*V]),
  .axis_z(axis_ab[0 +: 2*V]), .axis_x_c(r_more[2*V +: V]), .axis_y_c(r_more[V +: V]), .axis_z_c(r_more[0 +: V]),
  .half(depth - r_level), .octant(in_parent), .parent_edge_x(parent_more[9*V +: 3*V]),
  .parent_edge_y(parent_more[6*V +: 3*V]), .parent_edge_z(parent_more[3*V +: 3*V]));
assign parent_more[0 +: 3*V] = r_more[0 +: 3*V];
genvar axis;
generate
  for (axis = 0; axis < 3; axis = axis + 1) begin : corner
    wire [W-1:0] one = 1;
    assign parent_min[axis*W +: W] = r_min[axis*W +: W] & ~(one << octant_bit);
    assign parent_max[axis*W +: W] = parent_min[axis*W +: W] + (one << octant_bit << 1);
  end
endgenerate

wire accepted = (state == CHOOSE | state == FIT & known & ~box_outside) & ~rejected & ~goes_down;
reg  worked_back;
always @(posedge clk) worked_back <= state == UP & r_level - 1'b1 == p_level;

task accept;
  begin
    left <= left_after;
    draws <= c_leaf;
    state <= ~c_leaf & has_lod_depth ? VERDICT : SOLID;
  end
endtask

task take_up;
  begin
    {mask, leaves, left} <= {p_mask, p_leaves, p_left};
    first <= p_first;
    r_inside <= p_inside;
    state <= r_quad_level == p_quad_level ? UP : OUT;
  end
endtask

// The child has an undrawn sample. In a brick its node is known.
task seen;
  if (in_brick) go_down;
  else state <= NODE;
endtask
task go_down;
  if (left != 0) state <= PUSH;
  else become_parent;
endtask

task become_parent;
  begin
    {leaves, mask, first} <= c_of_node;
    left <= 8'hff;
    r_solid <= 0;
    r_node <= c_node;
    r_voxel_level <= c_level;
    r_inside <= c_inside;
    r_level <= c_level;
    r_quad_level <= c_quad_level;
    r_quad_x <= c_quad_x;
    r_quad_y <= c_quad_y;
    r_min <= c_min;
    r_max <= c_max;
    r_x <= c_x;
    r_y <= c_y;
    r_w <= c_w;
    r_more <= c_more;
    state <= CENTRE;
  end
endtask
