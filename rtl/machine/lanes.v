`include "widths.vh"
`include "stage.vh"
// Machines of stages B and C side by side draw tiles of the picture. They share two caches, the memory port and the pixel
// port. The context that has waited longest begins the next tile, row by row. Ties go to the lowest lane and context, and to
// nodes before attributes.
module lanes #(parameter LANES = 4, CONTEXTS = 1, TILE_LEVELS = 2, W = `WORD_BITS, PICTURE_LEVELS = 10,
               STACK_LOG2 = `STACK_LOG2, NODE_SETS_LOG2 = 6, ATTRIBUTE_SETS_LOG2 = 5, LEVEL_BOUND = W - 2,
               DEPTH = LEVEL_BOUND, NODE_WIDTH = `NODE_BITS, OUTER_ADDRESS = 32, BRICKS = 0) (
  input                        clk, reset,
  // Host, as of one machine.
  input                        constant_write,
  input [7:0]                  constant_address,
  input [W-1:0]                constant_data,
  input                        start,
  output                       busy,
  output reg                   done,
  output reg                   failed,
  // `fetch` stays until `fetch_ready`. Lines arrive in that order.
  output                       fetch,
  input                        fetch_ready,
  output                       fetch_attribute,
  output [`NODE_BITS-4:0]      fetch_line,
  input                        fill,
  input [63:0]                 fill_word,
  output                       pixel,
  input                        pixel_ready,
  output [`PLACE_BITS-1:0]     pixel_x, pixel_y,
  output [`NODE_BITS-1:0]      pixel_node,
  output [3*W-1:0]             pixel_voxel,
  output [`LEVEL_BITS-1:0]     pixel_level,
  output [63:0]                pixel_attribute);
  localparam L = `LEVEL_BITS, P = `PLACE_BITS, N = `NODE_BITS, A = OUTER_ADDRESS - 3;
  // Bits per pixel.
  localparam SHOWN = 2*P + N + 3*W + L + 64;
  localparam ALL = LANES*CONTEXTS;

  // ---------------------------------------------------------------- tiles, row by row
  reg [L-1:0] levels;
  reg [P-1:0] width, height;
  always @(posedge clk)
    if (constant_write)
      case (constant_address)
        8'd1: levels <= constant_data[L-1:0];
        8'd5: width <= constant_data[P-1:0];
        8'd6: height <= constant_data[P-1:0];
        default: ;
      endcase
  wire [P-1:0] last_column = (width - 1'b1) >> (levels - TILE_LEVELS);
  wire [P-1:0] last_row = (height - 1'b1) >> (levels - TILE_LEVELS);
  reg                   some_left, running;
  reg [TILE_LEVELS-1:0] column, row;        // of the next tile
  wire [LANES-1:0]      lane_failed;
  wire [ALL-1:0]        draws, begins, unused_tile;
  arbiter #(ALL) tiles (.clk(clk), .reset(reset), .enable(1'b1), .request(~draws & {ALL{some_left}}),
    .first(unused_tile), .grant(begins));
  assign busy = some_left | |draws;
  always @(posedge clk)
    if (reset)
      {some_left, running, done} <= 3'b000;
    else if (start) begin
      {some_left, running, done} <= 3'b110;
      {column, row} <= 0;
    end else begin
      if (|begins) begin
        column <= column == last_column ? {TILE_LEVELS{1'b0}} : column + 1'b1;
        if (column == last_column) row <= row + 1'b1;
        some_left <= column != last_column | row != last_row;
      end
      if (running & ~busy) {running, done} <= 2'b01;
    end
  // The flag stays until the next tile, so its rise counts.
  reg [LANES-1:0] failed_before;
  always @(posedge clk) begin
    failed_before <= lane_failed;
    failed <= ~(reset | start) & (failed | |(lane_failed & ~failed_before));
  end

  // ---------------------------------------------------------------- lanes
  wire [ALL-1:0]         node_request, node_taken, node_ready, attribute_request, attribute_taken, attribute_ready;
  wire [LANES-1:0]       pixel_request, pixel_taken;
  wire [ALL*A-1:0]       wanted;
  wire [ALL*64-1:0]      node_word, attribute_word;
  wire [LANES*SHOWN-1:0] shows;
  genvar i, j;
  generate
    for (i = 0; i < LANES; i = i + 1) begin : lane
      localparam FIRST = i*CONTEXTS;          // its first context
      wire [CONTEXTS*P-1:0] tile_x, tile_y;
      wire [CONTEXTS*N-1:0] node;
      for (j = 0; j < CONTEXTS; j = j + 1) begin : walks
        reg [TILE_LEVELS-1:0] x, y;
        always @(posedge clk)
          if (begins[FIRST + j]) {x, y} <= {column, row};
        assign tile_x[j*P +: P] = x;
        assign tile_y[j*P +: P] = y;
        assign wanted[(FIRST + j)*A +: A] = node[j*N +: A];
      end
      wire [N-1:0]   shown_node;
      wire [P-1:0]   x, y;
      wire [3*W-1:0] voxel;
      wire [L-1:0]   level;
      wire [63:0]    attribute;
      wire           unused_done, unused_fetch, unused_kind;
      wire [N-4:0]   unused_line;
      machine #(.W(W), .PICTURE_LEVELS(PICTURE_LEVELS), .STACK_LOG2(STACK_LOG2), .LEVEL_BOUND(LEVEL_BOUND),
                .DEPTH(DEPTH), .NODE_WIDTH(NODE_WIDTH), .OUTER_ADDRESS(OUTER_ADDRESS), .SHARED(1),
                .TILE_LEVELS(TILE_LEVELS), .CONTEXTS(CONTEXTS), .BRICKS(BRICKS)) walk (
        .clk(clk), .reset(reset), .constant_write(constant_write), .constant_address(constant_address),
        .constant_data(constant_data), .start(begins[FIRST +: CONTEXTS]), .busy(draws[FIRST +: CONTEXTS]),
        .done(unused_done), .failed(lane_failed[i]), .fetch(unused_fetch), .fetch_attribute(unused_kind),
        .fetch_line(unused_line), .fill(1'b0), .fill_word(64'b0), .pixel(pixel_request[i]), .pixel_x(x), .pixel_y(y),
        .pixel_node(shown_node), .pixel_voxel(voxel), .pixel_level(level), .pixel_attribute(attribute),
        .tile_x(tile_x), .tile_y(tile_y), .node_request(node_request[FIRST +: CONTEXTS]),
        .attribute_request(attribute_request[FIRST +: CONTEXTS]), .wanted_node(node),
        .shared_node_taken(node_taken[FIRST +: CONTEXTS]), .shared_node_ready(node_ready[FIRST +: CONTEXTS]),
        .shared_attribute_taken(attribute_taken[FIRST +: CONTEXTS]),
        .shared_attribute_ready(attribute_ready[FIRST +: CONTEXTS]), .shared_pixel_taken(pixel_taken[i]),
        .shared_node_word(node_word[FIRST*64 +: CONTEXTS*64]),
        .shared_attribute_word(attribute_word[FIRST*64 +: CONTEXTS*64]));
      assign shows[i*SHOWN +: SHOWN] = {x, y, shown_node, voxel, level, attribute};
    end
  endgenerate

  // ---------------------------------------------------------------- caches and their port
  wire         node_fetch, attribute_fetch;
  wire [A-4:0] node_line, attribute_line;
  wire [1:0]   next, fetched;               // nodes, attributes
  arbiter #(2) outer (.clk(clk), .reset(reset), .enable(fetch_ready), .request({attribute_fetch, node_fetch}),
    .first(next), .grant(fetched));
  assign fetch = |next;
  assign fetch_attribute = next[1];
  assign fetch_line = next[1] ? attribute_line : node_line;
  // Lines in flight, the oldest lowest: 1 for attributes.
  reg [2*ALL:0]       kinds;              // a one above the youngest
  reg [2:0]             filled;
  wire                  last_fill = fill & &filled;
  wire [2*ALL:0]      left = last_fill ? kinds >> 1 : kinds;
  always @(posedge clk)
    if (reset) begin
      kinds <= 1;
      filled <= 0;
    end else begin
      if (fill) filled <= filled + 1'b1;
      kinds <= |fetched ? add_kind(left, fetched[1]) : left;
    end
  function [2*ALL:0] add_kind(input [2*ALL:0] to, input kind);
    integer k;
    begin
      add_kind = to;
      for (k = 0; k < 2*ALL; k = k + 1)
        if (to >> k == 1) add_kind[k +: 2] = {1'b1, kind};
    end
  endfunction
  shared_cache #(.USERS(ALL), .SETS_LOG2(NODE_SETS_LOG2), .ADDRESS(A)) node_cache (.clk(clk),
    .reset(reset), .request(node_request), .address(wanted), .taken(node_taken), .ready(node_ready), .word(node_word),
    .fetch(node_fetch), .fetch_taken(fetched[0]), .fetch_line(node_line), .fill(fill & ~kinds[0]),
    .fill_word(fill_word));
  shared_cache #(.USERS(ALL), .SETS_LOG2(ATTRIBUTE_SETS_LOG2), .ADDRESS(A)) attribute_cache (.clk(clk),
    .reset(reset), .request(attribute_request), .address(wanted), .taken(attribute_taken), .ready(attribute_ready),
    .word(attribute_word), .fetch(attribute_fetch), .fetch_taken(fetched[1]), .fetch_line(attribute_line),
    .fill(fill & kinds[0]), .fill_word(fill_word));

  wire [LANES-1:0] shown;
  arbiter #(LANES) pixels (.clk(clk), .reset(reset), .enable(pixel_ready), .request(pixel_request), .first(shown),
    .grant(pixel_taken));
  reg [SHOWN-1:0]  of_shown;
  integer n;
  always @* begin
    of_shown = 0;
    for (n = 0; n < LANES; n = n + 1)
      of_shown = of_shown | shows[n*SHOWN +: SHOWN] & {SHOWN{shown[n]}};
  end
  assign pixel = |shown;
  assign {pixel_x, pixel_y, pixel_node, pixel_voxel, pixel_level, pixel_attribute} = of_shown;
endmodule
