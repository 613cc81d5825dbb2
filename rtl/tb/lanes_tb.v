`include "widths.vh"
`include "stage.vh"
// As frame_tb.v, with several lanes. The memory takes a request every eight cycles and has several in flight.
module lanes_tb #(parameter LANES = 4, CONTEXTS = 1, TILE_LEVELS = 2, PICTURE_LEVELS = 8, LEVEL_BOUND = `WORD_BITS - 2,
                  DEPTH = LEVEL_BOUND, NODE_WIDTH = `NODE_BITS, BRICKS = 0);   // as `lanes` has them
  localparam W = `WORD_BITS;
  // Cycles from a request to the first word; per line.
  localparam LATENCY = 52, LINE = 8;
  // Capacities: memory, stack, lines in flight.
  localparam NODES = 1 << 20, STACK_LOG2 = `STACK_LOG2, MOST = 64;
  reg clk = 0, reset = 1, start = 0, constant_write = 0;
  always #1 clk = ~clk;
  reg [7:0] constant_address = 0;
  reg [W-1:0] constant_data = 0;
  wire busy, done, failed, fetch, fetch_attribute, pixel;
  wire [`NODE_BITS-4:0] fetch_line;
  reg fill = 0;
  reg [63:0] fill_word = 0;
  wire [`PLACE_BITS-1:0] pixel_x, pixel_y;
  wire [`NODE_BITS-1:0] pixel_node;
  wire [3*W-1:0] pixel_voxel;
  wire [`LEVEL_BITS-1:0] pixel_level;
  wire [63:0] pixel_attribute;
  integer taken_for;
  wire fetch_ready = taken_for == 0;
  lanes #(.LANES(LANES), .CONTEXTS(CONTEXTS), .TILE_LEVELS(TILE_LEVELS),
          .PICTURE_LEVELS(PICTURE_LEVELS), .STACK_LOG2(STACK_LOG2),
          .LEVEL_BOUND(LEVEL_BOUND), .DEPTH(DEPTH), .NODE_WIDTH(NODE_WIDTH),
          .BRICKS(BRICKS)) dut (
    .clk(clk), .reset(reset), .constant_write(constant_write), .constant_address(constant_address),
    .constant_data(constant_data), .start(start), .busy(busy), .done(done), .failed(failed), .fetch(fetch),
    .fetch_ready(fetch_ready), .fetch_attribute(fetch_attribute), .fetch_line(fetch_line), .fill(fill),
    .fill_word(fill_word), .pixel(pixel), .pixel_ready(1'b1), .pixel_x(pixel_x), .pixel_y(pixel_y),
    .pixel_node(pixel_node), .pixel_voxel(pixel_voxel), .pixel_level(pixel_level),
    .pixel_attribute(pixel_attribute));

  // ------------------------------------------------ memory: nodes, and their numbers as attributes
  reg [63:0] nodes [0:NODES-1];
  reg [W-1:0] constants [0:`CONSTANTS-1];
  integer now, asked, answered, beat, due [0:MOST-1];
  reg of_attribute [0:MOST-1];
  reg [`NODE_BITS-1:0] at [0:MOST-1];
  wire [`NODE_BITS-1:0] word = at[answered % MOST] + beat;
  initial {now, asked, answered, beat, taken_for} = 0;
  always @(posedge clk) if (~reset) begin
    now <= now + 1;
    taken_for <= fetch & fetch_ready ? LINE - 1 : taken_for == 0 ? 0 : taken_for - 1;
    if (fetch & fetch_ready) begin
      of_attribute[asked % MOST] <= fetch_attribute;
      at[asked % MOST] <= {fetch_line, 3'd0};
      due[asked % MOST] <= now + LATENCY;
      asked <= asked + 1;
    end
    fill <= 0;
    if (answered != asked && due[answered % MOST] <= now + 1) begin
      fill <= 1;
      fill_word <= of_attribute[answered % MOST] ? word : word < NODES ? nodes[word] : 0;
      beat <= beat == LINE - 1 ? 0 : beat + 1;
      if (beat == LINE - 1) answered <= answered + 1;
    end
  end

  `define WALK dut.lane[lane].walk
  `define TILE (`WALK.tile_y_now << TILE_LEVELS | `WALK.tile_x_now)
  `define WATCHED 2
  `define ATTRIBUTE(node) node
  `include "tb/frame.vh"
  genvar lane;
  generate
    for (lane = 0; lane < LANES; lane = lane + 1) begin : watched
      always @(posedge clk) if (has_events) begin
        `include "tb/ports.vh"
      end
    end
  endgenerate

  initial begin
    `include "tb/draw.vh"
    while (!done && cycles < most) @(posedge clk) #1;
    if (done && !failed) $display("%0d cycles", cycles);
    else $display("failed: %s", done ? "the stack is full" : "no end");
    $finish;
  end
endmodule
