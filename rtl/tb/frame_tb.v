`include "widths.vh"
`include "stage.vh"
// Draws a frame of `shiftvox model --vectors`. Writes pixels.txt, with +events events.txt, with +picture picture.png,
// and prints the cycles. +most=N limits them, +states prints them per state, +wave=FILE writes a waveform.
module frame_tb #(parameter PICTURE_LEVELS = 8, LEVEL_BOUND = `WORD_BITS - 2, DEPTH = LEVEL_BOUND,
                  NODE_WIDTH = `NODE_BITS, BRICKS = 0);   // as `machine` has them
  localparam W = `WORD_BITS;
  // Cycles from a request to the first word.
  localparam LATENCY = 50;
  // Capacities of memory and stack. Icarus Verilog clears memory slowly.
`ifdef VERILATOR
  localparam NODES = 1 << 22;
`else
  localparam NODES = 1 << 14;
`endif
  localparam STACK_LOG2 = `STACK_LOG2;
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
  machine #(.PICTURE_LEVELS(PICTURE_LEVELS), .STACK_LOG2(STACK_LOG2), .LEVEL_BOUND(LEVEL_BOUND), .DEPTH(DEPTH),
            .NODE_WIDTH(NODE_WIDTH), .BRICKS(BRICKS)) dut (
    .clk(clk), .reset(reset), .constant_write(constant_write), .constant_address(constant_address),
    .constant_data(constant_data), .start(start), .busy(busy), .done(done), .failed(failed), .fetch(fetch),
    .fetch_attribute(fetch_attribute), .fetch_line(fetch_line), .fill(fill), .fill_word(fill_word),
    .pixel(pixel), .pixel_x(pixel_x), .pixel_y(pixel_y), .pixel_node(pixel_node), .pixel_voxel(pixel_voxel),
    .pixel_level(pixel_level), .pixel_attribute(pixel_attribute));

  // ------------------------------------------------ memory: nodes and attributes, or numbers in their place
  reg [63:0] nodes [0:NODES-1], attributes [0:NODES-1];
  reg has_attributes;
  function [63:0] word(input [`NODE_BITS-1:0] node, input attribute);
    word = attribute & ~has_attributes ? node : node >= NODES ? 0 : attribute ? attributes[node] : nodes[node];
  endfunction
  reg [W-1:0] constants [0:`CONSTANTS-1];
  integer wait_for, beat;
  reg of_attribute;
  reg [`NODE_BITS-1:0] at;
  initial begin
    wait_for = -1;
    beat = 8;
  end
  always @(posedge clk) begin
    fill <= 0;
    if (fetch) begin
      wait_for <= LATENCY - 1;
      of_attribute <= fetch_attribute;
      at <= {fetch_line, 3'd0};
    end else if (wait_for > 0)
      wait_for <= wait_for - 1;
    else if (wait_for == 0) begin
      wait_for <= -1;
      beat <= 1;
      fill <= 1;
      fill_word <= word(at, of_attribute);
    end else if (beat < 8) begin
      beat <= beat + 1;
      fill <= 1;
      fill_word <= word(at + beat, of_attribute);
    end
  end

  `define WALK dut
  `define TILE 0
  `define WATCHED 1
  `define ATTRIBUTE(node) word(node, 1'b1)
  `include "tb/frame.vh"
  `define BACKGROUND 24'heceff4
  localparam SAMPLES = 1 << 2*PICTURE_LEVELS;
  reg [23:0] picture [0:SAMPLES-1];
  `include "tb/picture.vh"
  integer in_state [0:63];
  always @(posedge clk) if (busy) begin
    in_state[dut.state] <= in_state[dut.state] + 1;
    if (pixel & has_attributes) picture[pixel_y*constants[5] + pixel_x] <= pixel_attribute[23:0];
    if (has_events) begin
      `include "tb/ports.vh"
    end
  end

  initial begin
    for (i = 0; i < 64; i = i + 1) in_state[i] = 0;
    has_attributes = $test$plusargs("picture");
    if (has_attributes) begin
      $readmemh("frame.attributes.hex", attributes);
      for (i = 0; i < SAMPLES; i = i + 1) picture[i] = `BACKGROUND;
    end
    `include "tb/draw.vh"
    while (busy && cycles < most) @(posedge clk) #1;
    if ($test$plusargs("states"))
      for (i = 0; i < 64; i = i + 1)
        if (in_state[i] != 0) $display("state %0d: %0d", i, in_state[i]);
    if (has_attributes & done & ~failed) put_picture(constants[5], constants[6]);
    if (done && !failed) $display("%0d cycles", cycles);
    else $display("failed: %s", done ? "the stack is full" : "no end");
    $finish;
  end
endmodule
