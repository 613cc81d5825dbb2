// Stages A and B: children wait on the stack with all their data. The popped record is drawn or subdivided.
assign t_level = r_level, t_voxel_level = r_voxel_level, t_quad_level = r_quad_level, t_node = r_node;
assign t_quad_x = r_quad_x, t_quad_y = r_quad_y, t_min = r_min, t_max = r_max, t_w_min = r_w_min, t_more = r_more;
assign asked_level = r_quad_level, asked_x = r_quad_x, asked_y = r_quad_y;
assign lod_look_up = state == FILLED, lod_level = r_level;
assign node_place = r_node;

localparam LEVEL = $clog2(LEVEL_BOUND + 1), QUAD_LEVEL = $clog2(PICTURE_LEVELS + 1), QUAD_PLACE = PICTURE_LEVELS;
localparam CORNER = LEVEL_BOUND + 1;          // a coordinate, from 0 to 2^LEVEL_BOUND
localparam REST = `REST_BITS;
localparam ENTRY = 2 + LEVEL + QUAD_LEVEL + NODE_WIDTH + 2*QUAD_PLACE + 6*CORNER + 2*CAGE + REST;
function [3*CORNER-1:0] corner_bits(input [3*W-1:0] v);
  corner_bits = {v[2*W +: CORNER], v[W +: CORNER], v[0 +: CORNER]};
endfunction
wire [REST-1:0]  pushed_rest, popped_rest;
wire [ENTRY-1:0] pushed = {c_solid, c_inside, c_level[LEVEL-1:0], c_quad_level[QUAD_LEVEL-1:0],
  c_node[NODE_WIDTH-1:0], c_quad_x[QUAD_PLACE-1:0], c_quad_y[QUAD_PLACE-1:0], corner_bits(c_min),
  corner_bits(c_max), c_x, c_y, pushed_rest};
wire [ENTRY-1:0] popped;
wire             p_solid, p_inside;
wire [LEVEL-1:0] p_level;
wire [QUAD_LEVEL-1:0]  p_quad_level;
wire [NODE_WIDTH-1:0]  p_node;
wire [QUAD_PLACE-1:0]  p_quad_x, p_quad_y;
wire [CORNER-1:0]      p_min_x, p_min_y, p_min_z, p_max_x, p_max_y, p_max_z;
wire [CAGE-1:0]        p_x, p_y;
assign {p_solid, p_inside, p_level, p_quad_level, p_node, p_quad_x, p_quad_y, p_min_x, p_min_y, p_min_z,
  p_max_x, p_max_y, p_max_z, p_x, p_y, popped_rest} = popped;
function [W-1:0] corner_word(input [CORNER-1:0] v);
  corner_word = v;
endfunction
// The stage's part.
wire [L-1:0]     p_voxel_level;
wire [CAGE-1:0]  p_w;
wire [W-1:0]     p_w_min;
wire [MORE-1:0]  p_more;
memory #(.BITS(ENTRY), .WORDS(1 << STACK_LOG2), .ADDRESS(STACK_LOG2)) stack (.clk(clk),
  .read(state == POP), .write(state == PUSH & ~stack_full),
  .address(state == PUSH ? stacked[STACK_LOG2-1:0] : top), .data_in(pushed), .data_out(popped));

localparam LOOK = VERDICT;                      // takes the node's word
wire solid;
wire [7:0]   mask_read = node_word[39:32];
wire leaf = ~r_solid & (r_level >= depth | mask_read == 0);

// ---------------------------------------------------------------- children, the farthest first
localparam POOL_BITS = `POOL_WORDS*W;         // one coordinate of the pool
wire [POOL_BITS-1:0] pool_x_now, pool_y_now, pool_w_now;
reg  [POOL_BITS-1:0] pool_x, pool_y, pool_w;
midpoints #(W) midpoints_x (.parent(r_x), .pool(pool_x_now));
midpoints #(W) midpoints_y (.parent(r_y), .pool(pool_y_now));
midpoints #(W) midpoints_w (.parent(r_w), .pool(pool_w_now));
child_vertices #(W) vertices_x (.pool(pool_x), .octant(octant), .child(child_x));
child_vertices #(W) vertices_y (.pool(pool_y), .octant(octant), .child(child_y));
child_vertices #(W) vertices_w (.pool(pool_w), .octant(octant), .child(child_w));
assign order_used = order;
assign any_left = left_after != 0;
integer place;
always @* begin
  octant = 0;
  for (place = 7; place >= 0; place = place - 1)
    if (left[place]) octant = order[3*place +: 3];
  left_after = left & (left - 8'd1);
end

// ---------------------------------------------------------------- fill vectors: all in one memory
assign vector = vector_there, known = 1'b0, elsewhere = 1'b0, last_level = levels, marked_all = &marked;
wire of_drawn = draw_read;

task mark_sample;
  begin
    marked <= 4'b1111;
    state <= MARK;
  end
endtask

task accept;
  state <= PUSH;
endtask
