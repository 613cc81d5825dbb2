`include "widths.vh"
`include "stage.vh"
// One lane, one record at a time. It is popped, and dropped if its picture node is full. Its octree node is read. Then it is
// drawn or dropped, or its children are fitted and the visible ones pushed. docs/rtl.md has ports, states and cycles.
//
// A stage adds `stage.vh` (widths), `parts.vh` (registers and blocks) and `steps.vh` (states). The stack holds children in
// A and B (`children.vh`), parents in C. 2^PICTURE_LEVELS samples per side, DEPTH levels of the object, LEVEL_BOUND of
// records, 2^OUTER_ADDRESS bytes off chip.
//
// SHARED: a lane of lanes.v. It draws tiles, nodes TILE_LEVELS below the picture's root; caches and ports are outside.
// CONTEXTS (contexts.vh, stage C): a power of two. Stage C needs two picture levels below TILE_LEVELS.
module machine #(parameter W = `WORD_BITS, F = `FRACTION_BITS, PICTURE_LEVELS = 10, STACK_LOG2 = `STACK_LOG2,
                 NODE_SETS_LOG2 = 6, ATTRIBUTE_SETS_LOG2 = 5, LEVEL_BOUND = W - 2, DEPTH = LEVEL_BOUND,
                 NODE_WIDTH = `NODE_BITS, OUTER_ADDRESS = 32, SHARED = 0, TILE_LEVELS = 0,
                 CONTEXTS = 1, BRICKS = 0) (
  input                        clk, reset,
  // Host.
  input                        constant_write,
  input [7:0]                  constant_address,
  input [W-1:0]                constant_data,
  input [CONTEXTS-1:0]         start,
  output [CONTEXTS-1:0]        busy,
  output                       done,
  output reg                   failed,          // full stack
  // Memory: lines of eight 64-bit words.
  output                       fetch,
  output                       fetch_attribute,
  output [`NODE_BITS-4:0]      fetch_line,
  input                        fill,
  input [63:0]                 fill_word,
  output                       pixel,
  output [`PLACE_BITS-1:0]     pixel_x, pixel_y,
  output [`NODE_BITS-1:0]      pixel_node,
  output [3*W-1:0]             pixel_voxel,
  output [`LEVEL_BITS-1:0]     pixel_level,
  output [63:0]                pixel_attribute,
  // SHARED, per context: the tile, requests, held until taken, and answers.
  input [CONTEXTS*`PLACE_BITS-1:0] tile_x, tile_y,
  output [CONTEXTS-1:0]        node_request, attribute_request,
  output [CONTEXTS*`NODE_BITS-1:0] wanted_node,
  input [CONTEXTS-1:0]         shared_node_taken, shared_node_ready, shared_attribute_taken, shared_attribute_ready,
  input                        shared_pixel_taken,
  input [CONTEXTS*64-1:0]      shared_node_word, shared_attribute_word);
  localparam L = `LEVEL_BITS, P = `PLACE_BITS, N = `NODE_BITS, V = `WIDE_BITS;
  // Bits of one coordinate of a cage, and of the stage's own fields of a record.
  localparam CAGE = `CAGE_WORDS*W, MORE = `MORE_BITS;

  wire [N-1:0] root;
  wire [L-1:0] levels, depth, level_bound, sub_levels;
  wire [P-1:0] width, height;
  wire         coarse, has_lod_depth, positive, root_leaf;
  wire [3*W-1:0] origin, eye_floor, eye_ceil;
  wire [9*W-1:0] edges;
  wire signed [W-1:0] near, near_crossing, size_limit, lod_limit, least_size, lod_depth;

  localparam IDLE = 0, CLEAR = 1, OBJECT = 2, OBJECT_BOX = 3, FIT = 4, CHOOSE = 5, PUSH = 6, POP = 7,
    POPPED = 8, FILLED = 9, OPEN = 10, NODE = 11, VERDICT = 12, WALK = 13, WALKED = 14, BACK = 15, CENTRE = 16,
    ORDER = 17, POOL = 18, CHILD = 19, DRAWN = 20, ATTRIBUTE = 21, SHOW = 22, PIXEL = 23, MARK = 24, ABOVE = 25,
    SET = 26, DONE = 27, ROOT = 28;
  // The stage's begin at 32.
  reg [5:0] state;
  assign done = state == DONE;

  // ---------------------------------------------------------------- the running context
  localparam CONTEXT_LOG2 = $clog2(CONTEXTS), BITS_OF_CONTEXT = CONTEXT_LOG2 == 0 ? 1 : CONTEXT_LOG2;
  reg [BITS_OF_CONTEXT-1:0] running;
  reg [P-1:0]  tile_x_now, tile_y_now;
  reg [63:0]   node_word_now, attribute_word_now;

  // ---------------------------------------------------------------- the current record
  reg              r_solid, r_inside;
  reg [L-1:0]      r_level, r_voxel_level, r_quad_level;
  reg [N-1:0]      r_node;
  reg [P-1:0]      r_quad_x, r_quad_y;
  reg [3*W-1:0]    r_min, r_max;
  reg [CAGE-1:0]   r_x, r_y, r_w;
  reg signed [W-1:0] r_w_min;
  reg [MORE-1:0]   r_more;

  // The current child, or the record's box and a picture node.
  reg              c_solid, c_inside;
  reg [L-1:0]      c_level, c_voxel_level, c_quad_level;
  reg [N-1:0]      c_node;
  reg [P-1:0]      c_quad_x, c_quad_y;
  reg [3*W-1:0]    c_min, c_max;
  reg [CAGE-1:0]   c_x, c_y, c_w;
  reg signed [W-1:0] c_w_min;
  reg [MORE-1:0]   c_more;

  wire [L-1:0]     t_level, t_voxel_level, t_quad_level, asked_level;
  wire [N-1:0]     t_node;
  wire [P-1:0]     t_quad_x, t_quad_y, asked_x, asked_y;
  wire [3*W-1:0]   t_min, t_max;
  wire signed [W-1:0] t_w_min;
  wire [MORE-1:0]  t_more;

  // ---------------------------------------------------------------- on-chip memories
  reg [STACK_LOG2:0] stacked;                   // entries on the stage's stack
  wire stack_full = stacked[STACK_LOG2];
  wire [STACK_LOG2-1:0] top = stacked[STACK_LOG2-1:0] - 1'b1;

  // The tile's fill vectors by level and row, then those of nodes above the tile. Level n starts at 0101..01 with n ones.
  localparam VECTOR_LEVELS = PICTURE_LEVELS - TILE_LEVELS - `JOINED_LEVELS,
    LAST_VECTORS = `JOINED_LEVELS != 0 && VECTOR_LEVELS < 1 ? 1 : VECTOR_LEVELS;
  localparam TILE_WORDS = ((1 << (2*LAST_VECTORS + 2)) - 1) / 3;
  localparam FILL_WORDS = TILE_WORDS + TILE_LEVELS, FILL_ADDRESS = $clog2(FILL_WORDS + 2);
  function [FILL_ADDRESS-1:0] fill_place(input [L-1:0] level, input [P-1:0] x, input [P-1:0] y);
    if (TILE_LEVELS == 0)
      fill_place = ({(PICTURE_LEVELS + 1){2'b01}} & ~({FILL_ADDRESS{1'b1}} << 2*level)) + (y << level) + x;
    else if (level < TILE_LEVELS)
      fill_place = TILE_WORDS + level;
    else
      fill_place = ({(PICTURE_LEVELS + 1){2'b01}} & ~({FILL_ADDRESS{1'b1}} << 2*(level - TILE_LEVELS)))
        + ((y & ~({P{1'b1}} << (level - TILE_LEVELS))) << (level - TILE_LEVELS))
        + (x & ~({P{1'b1}} << (level - TILE_LEVELS)));
  endfunction
  wire [3:0] vector, vector_there;              // of the requested node; as stored here
  wire       known;                             // no read needed
  wire       elsewhere;                         // stored by the stage
  wire [L-1:0] last_level;                      // with vectors or words
  reg  [3:0] marked;                            // what is written next
  wire       marked_all;
  reg  [3:0] outside_picture;
  wire fill_read  = state == FIT & ~box_outside | state == FILLED | state == ABOVE | draw_read;
  wire fill_write = state == CLEAR | state == MARK;
  wire of_record  = state == FILLED | state == OPEN;
  wire [L-1:0] fill_level = of_record ? asked_level : of_drawn ? draw_level : c_quad_level;
  wire [P-1:0] fill_x = of_record ? asked_x : of_drawn ? draw_x : c_quad_x;
  wire [P-1:0] fill_y = of_record ? asked_y : of_drawn ? draw_y : c_quad_y;
  wire [FILL_ADDRESS-1:0] fill_address = fill_place(fill_level, fill_x, fill_y);
  memory #(.BITS(4), .WORDS(FILL_WORDS << CONTEXT_LOG2), .ADDRESS(FILL_ADDRESS + CONTEXT_LOG2)) fill_vectors (
    .clk(clk), .read(fill_read & ~elsewhere), .write(fill_write & ~elsewhere),
    .address({{CONTEXT_LOG2{1'b0}}, fill_address} << CONTEXT_LOG2 | running),
    .data_in(state == CLEAR ? outside_picture : marked), .data_out(vector_there));

  // Initial vectors: quadrants whose first sample is outside the picture are full.
  integer q;
  reg [P:0] first_x, first_y;
  always @*
    for (q = 0; q < 4; q = q + 1) begin
      first_x = c_quad_x << (levels - c_quad_level);
      first_y = c_quad_y << (levels - c_quad_level);
      if (c_quad_level != levels) begin
        first_x = first_x + (q[0] ? 1 << (levels - c_quad_level) >> 1 : 0);
        first_y = first_y + (q[1] ? 1 << (levels - c_quad_level) >> 1 : 0);
      end
      outside_picture[q] = first_x >= {1'b0, width} | first_y >= {1'b0, height};
      // Above the tile, only the path to it is not full.
      if (c_quad_level < TILE_LEVELS)
        outside_picture[q] = q != {below_y[0], below_x[0]};
    end
  // The tile's first node on a level, or its ancestor.
  function [P-1:0] way(input [P-1:0] of_tile, input [L-1:0] level);
    reg [P+TILE_LEVELS-1:0] shifted;
    begin
      shifted = of_tile << level;
      way = shifted >> TILE_LEVELS;
    end
  endfunction
  wire [P-1:0] first_x_of = SHARED ? way(tile_x_now, c_quad_level) : 0;
  wire [P-1:0] below_x = SHARED ? way(tile_x_now, c_quad_level + 1'b1) : 0;
  wire [P-1:0] below_y = SHARED ? way(tile_y_now, c_quad_level + 1'b1) : 0;
  wire [L-1:0] in_tile = c_quad_level < TILE_LEVELS ? 0 : c_quad_level - TILE_LEVELS;
  wire last_of_row   = &(c_quad_x | ~({P{1'b1}} >> (P - in_tile)));
  wire last_of_level = last_of_row & &(c_quad_y | ~({P{1'b1}} >> (P - in_tile)));

  wire        node_taken, node_ready, attribute_taken, attribute_ready, pixel_taken;
  wire [63:0] node_word, attribute_word;
  localparam A = OUTER_ADDRESS - 3;             // of a word of eight bytes
  wire [N-1:0] node_place;                      // of its word, by the stage
  generate
    if (SHARED) begin : shared
      assign node_taken = |(shared_node_taken & runs), attribute_taken = |(shared_attribute_taken & runs);
      assign node_ready = |((shared_node_ready | answered) & runs);
      assign attribute_ready = |((shared_attribute_ready | answered) & runs);
      assign {node_word, attribute_word, pixel_taken} = {node_word_now, attribute_word_now, shared_pixel_taken};
      assign {fetch, fetch_attribute, fetch_line} = 0;
    end else begin : own
      wire         node_fetch, attribute_fetch;
      wire [A-4:0] node_line, attribute_line;
      reg          filling_attributes;
      cache #(.SETS_LOG2(NODE_SETS_LOG2), .ADDRESS(A)) node_cache (.clk(clk), .reset(reset), .request(node_request),
        .address(wanted_node[A-1:0]), .ready(node_ready), .word(node_word), .fetch(node_fetch), .fetch_line(node_line),
        .fill(fill & ~filling_attributes), .fill_word(fill_word));
      cache #(.SETS_LOG2(ATTRIBUTE_SETS_LOG2), .ADDRESS(A)) attribute_cache (.clk(clk), .reset(reset),
        .request(attribute_request), .address(wanted_node[A-1:0]), .ready(attribute_ready), .word(attribute_word),
        .fetch(attribute_fetch), .fetch_line(attribute_line), .fill(fill & filling_attributes),
        .fill_word(fill_word));
      assign {node_taken, attribute_taken, pixel_taken} = 3'b111;
      assign fetch = node_fetch | attribute_fetch;
      assign fetch_attribute = attribute_fetch;
      assign fetch_line = attribute_fetch ? attribute_line : node_line;
      always @(posedge clk)
        if (fetch) filling_attributes <= attribute_fetch;
    end
  endgenerate

  frame_constants #(W) constants (.clk(clk), .write(constant_write), .address(constant_address),
    .data(constant_data), .root(root), .levels(levels), .depth(depth), .level_bound(level_bound),
    .sub_levels(sub_levels), .width(width), .height(height), .coarse(coarse), .origin(origin), .edges(edges),
    .eye_floor(eye_floor), .eye_ceil(eye_ceil), .positive(positive), .root_leaf(root_leaf),
    .near(near), .near_crossing(near_crossing), .size_limit(size_limit),
    .lod_limit(lod_limit), .least_size(least_size), .look_up(lod_look_up), .of_level(lod_level),
    .has_lod_depth(has_lod_depth), .lod_depth(lod_depth));

  wire [CAGE-1:0] object_x, object_y, object_w;
  object_cage #(W) cage_x (.corner(origin[2*W +: W]), .edges(edges[6*W +: 3*W]), .cage(object_x));
  object_cage #(W) cage_y (.corner(origin[W +: W]), .edges(edges[3*W +: 3*W]), .cage(object_y));
  object_cage #(W) cage_w (.corner(origin[0 +: W]), .edges(edges[0 +: 3*W]), .cage(object_w));

  wire full;
  filled is_filled (.vector(vector), .full(full));

  reg [7:0]   mask;
  reg [N-1:0] first;
  wire [3*W-1:0] centre_now;
  reg  [3*W-1:0] middle;
  centre #(W) centre_of (.min(r_min), .max(r_max), .centre(centre_now));
  wire [2:0]  octant_now;
  wire [23:0] order_now;
  octant_order #(W) order_of (.centre(middle), .eye_floor(eye_floor), .octant(octant_now), .child(order_now));
  reg  [23:0] order;                            // the nearest highest
  // Children, the farthest lowest.
  reg  [7:0] left;
  reg  [7:0] there;
  reg  [2:0] octant;
  reg  [7:0] left_after;
  wire       any_left;
  wire [23:0] order_used;                       // `order`, or its next value
  integer r;
  always @*
    for (r = 0; r < 8; r = r + 1)
      there[r] = r_solid | mask[order_used[3*r +: 3]];
  wire [7:0] earlier = mask & ~(8'hff << octant);
  wire [3:0] count = earlier[0] + earlier[1] + earlier[2] + earlier[3] + earlier[4] + earlier[5] + earlier[6];
  wire [CAGE-1:0] child_x, child_y, child_w;
  wire [3*W-1:0] child_min, child_max;
  child_corners #(W) corners (.min(r_min), .max(r_max), .centre(middle), .octant(octant),
    .child_min(child_min), .child_max(child_max));
  wire signed [W-1:0] w_low, w_high;
  child_span #(W) span_w (.child(state == OBJECT_BOX ? c_w : child_w), .low(w_low), .high(w_high));

  wire lod_look_up;                             // of the depth of a level
  wire [L-1:0] lod_level;

  // ---------------------------------------------------------------- fit: a box down the image quadtree
  reg  fresh;                                   // the edges are not tested
  wire box_outside_now, box_enclosed, box_near, rejected, single;
  wire [3:0] overlapped;
  wire [1:0] only;
  wire [CAGE-1:0] inner_x, inner_y;
  wire [1:0] quadrant;                          // to continue in
  wire box_outside = fresh & ~c_inside & box_outside_now;
  node_choice choice (.overlapped(overlapped), .vector(vector), .rejected(rejected), .single(single),
    .quadrant(only));
  wire inside_now = c_inside | fresh & box_enclosed;
  wire goes_down = single & c_quad_level < levels & (inside_now | c_screen | box_near);

  // Quadrants left per level.
  reg  [4*(PICTURE_LEVELS + 1)-1:0] waiting;
  wire [3:0] open = ~vector;
  reg  [L-1:0] back_level;                      // the deepest with some left
  reg  back_any;
  integer l;
  always @* begin
    back_any = 0;
    back_level = 0;
    for (l = 0; l <= PICTURE_LEVELS; l = l + 1)
      if (|waiting[4*l +: 4]) begin
        back_any = 1;
        back_level = l;
      end
  end

  // ---------------------------------------------------------------- pixels and fill vectors
  wire [3:0] after;
  wire       now_full;
  reg  [3:0] quadrant_bit;
  fill_update update (.vector(vector), .bits(quadrant_bit), .after(after), .full(now_full));
  wire [L-1:0] side = depth - t_voxel_level;    // of the voxel, log2
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : voxel
      wire [W-1:0] finest = t_min[k*W +: W] >> sub_levels;
      assign pixel_voxel[k*W +: W] = finest >> side << side;
    end
  endgenerate
  assign pixel = state == PIXEL;
  assign pixel_x = c_quad_x;
  assign pixel_y = c_quad_y;
  assign pixel_node = t_node;
  assign pixel_level = t_voxel_level;
  assign pixel_attribute = attribute_word;

  wire [5:0] next_record = stacked == 0 ? DONE : POP;
  wire [5:0] next_child = any_left ? CHILD : next_record;

  task go_to_quadrant(input [1:0] to);
    begin
      c_quad_level <= c_quad_level + 1'b1;
      c_quad_x <= {c_quad_x[P-2:0], to[0]};
      c_quad_y <= {c_quad_y[P-2:0], to[1]};
      if (~c_screen) begin
        c_x <= inner_x;
        c_y <= inner_y;
      end
    end
  endtask

  task begin_tile;
    begin
      failed <= 0;
      stacked <= 0;
      c_quad_level <= 0;
      c_quad_x <= 0;
      c_quad_y <= 0;
      state <= CLEAR;
    end
  endtask

  task choose;
    if (rejected) begin
      left <= left_after;
      state <= next_child;
    end else if (goes_down) begin
      go_to_quadrant(quadrant);
      c_more <= inner_more;
      state <= FIT;
    end else
      accept;
  endtask

  `include "parts.vh"
  `include "contexts.vh"
  localparam KEPT = 6 + `KEPT_BITS, WAITING = 4*(PICTURE_LEVELS + 1);
  reg  [WAITING+KEPT-1:0] kept [0:CONTEXTS-1];
  wire [WAITING+KEPT-1:0] kept_of_next = kept[next_running];
  always @(posedge clk)
    if (switches) kept[running] <= {waiting, state_then, `KEPT};

  always @(posedge clk)
    if (reset) begin
      state <= IDLE;
      failed <= 0;
    end else if (switches) begin
      {state, `KEPT} <= kept_of_next[KEPT-1:0];
      waiting <= kept_of_next[KEPT +: WAITING];
      if (next_begins) begin_tile;
    end else
      case (state)
        IDLE, DONE: if (starts) begin_tile;
        CLEAR: begin
          c_quad_x <= last_of_level ? below_x : last_of_row ? first_x_of : c_quad_x + 1'b1;
          if (last_of_row) c_quad_y <= last_of_level ? below_y : c_quad_y + 1'b1;
          if (last_of_level) c_quad_level <= c_quad_level + 1'b1;
          if (last_of_level & c_quad_level == last_level) state <= OBJECT;
        end
        OBJECT: begin
          {c_solid, c_inside} <= 2'b0;
          c_level <= 0;
          c_voxel_level <= 0;
          c_quad_level <= 0;
          c_quad_x <= 0;
          c_quad_y <= 0;
          c_node <= root;
          c_min <= 0;
          c_max <= {3{{{(W-1){1'b0}}, 1'b1} << depth << sub_levels}};
          c_x <= object_x;
          c_y <= object_y;
          c_w <= object_w;
          c_more <= object_more;
          left <= 0;
          state <= OBJECT_BOX;
        end
        OBJECT_BOX: begin
          c_w_min <= w_low;
          fresh <= 1;
          state <= behind ? next_record : FIT;
        end
        POP: begin
          stacked <= stacked - 1'b1;
          state <= POPPED;
        end
        FILLED: state <= OPEN;
        OPEN:
          if (full) state <= next_record;
          else take_up;
        CENTRE: begin
          middle <= centre_now;
          state <= ORDER;
        end
        CHILD: begin
          c_solid <= r_solid;
          c_inside <= r_inside;
          c_level <= r_level + 1'b1;
          c_voxel_level <= r_solid ? r_voxel_level : r_level + 1'b1;
          c_quad_level <= r_quad_level;
          c_quad_x <= r_quad_x;
          c_quad_y <= r_quad_y;
          c_node <= r_solid ? r_node : first + count;
          c_min <= child_min;
          c_max <= child_max;
          c_x <= child_x;
          c_y <= child_y;
          c_w <= r_screen ? {CAGE{1'b0}} : child_w;
          c_w_min <= r_screen ? {W{1'b0}} : w_low;
          c_more <= child_more;
          fresh <= 1;
          if (behind) begin
            left <= left_after;
            state <= next_child;
          end else
            state <= FIT;
        end
        FIT:
          if (box_outside) begin
            left <= left_after;
            state <= next_child;
          end else begin
            c_inside <= inside_now;
            fresh <= 0;
            if (known) choose;
            else state <= CHOOSE;
          end
        CHOOSE: choose;
        DRAWN:
          if (full) draw_on;
          else state <= ATTRIBUTE;
        ATTRIBUTE: if (attribute_taken) state <= SHOW;
        SHOW: if (attribute_ready) state <= PIXEL;
        PIXEL: if (pixel_taken) mark_sample;
        MARK:
          if (marked_all & c_quad_level != 0) begin
            quadrant_bit <= 4'b0001 << {c_quad_y[0], c_quad_x[0]};
            c_quad_level <= c_quad_level - 1'b1;
            c_quad_x <= c_quad_x >> 1;
            c_quad_y <= c_quad_y >> 1;
            state <= ABOVE;
          end else if (levels == 0)
            state <= ROOT;
          else
            draw_on;
        // Only for a picture of one sample.
        ROOT: draw_on;
        ABOVE: state <= SET;
        SET: begin
          marked <= after;
          state <= MARK;
        end
        `include "steps.vh"
        default: state <= IDLE;
      endcase
endmodule
