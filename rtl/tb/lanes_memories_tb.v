`include "stage.vh"
// Prints the memory bits of several lanes, like memories_tb.v.
module lanes_memories_tb #(parameter LANES = 4, CONTEXTS = 1, TILE_LEVELS = 2, PICTURE_LEVELS = 8, LEVEL_BOUND = 30,
                           DEPTH = LEVEL_BOUND, NODE_WIDTH = 32, BRICKS = 0);
  reg clk, reset, constant_write, start, fetch_ready, fill, pixel_ready;
  reg [7:0] constant_address;
  reg [31:0] constant_data;
  reg [63:0] fill_word;
  lanes #(.LANES(LANES), .CONTEXTS(CONTEXTS), .TILE_LEVELS(TILE_LEVELS),
          .PICTURE_LEVELS(PICTURE_LEVELS), .LEVEL_BOUND(LEVEL_BOUND),
          .DEPTH(DEPTH), .NODE_WIDTH(NODE_WIDTH), .BRICKS(BRICKS)) dut (
    .clk(clk), .reset(reset), .constant_write(constant_write), .constant_address(constant_address),
    .constant_data(constant_data), .start(start), .fetch_ready(fetch_ready), .fill(fill), .fill_word(fill_word),
    .pixel_ready(pixel_ready));
  initial begin
    $display("record stack: %0d", LANES*dut.lane[0].walk.stack.BITS*dut.lane[0].walk.stack.WORDS);
    $display("fill vectors: %0d", LANES*`FILL_BITS(dut.lane[0].walk));
    $display("node cache: %0d",
      dut.node_cache.WAYS*dut.node_cache.ways[0].of_words.BITS*dut.node_cache.ways[0].of_words.WORDS);
    $display("node cache, tags: %0d",
      dut.node_cache.WAYS*dut.node_cache.ways[0].of_tags.BITS*dut.node_cache.ways[0].of_tags.WORDS
      + dut.node_cache.of_order.BITS*dut.node_cache.of_order.WORDS + $bits(dut.node_cache.valid));
    $display("attribute cache: %0d", dut.attribute_cache.WAYS*dut.attribute_cache.ways[0].of_words.BITS
      *dut.attribute_cache.ways[0].of_words.WORDS);
    $display("attribute cache, tags: %0d",
      dut.attribute_cache.WAYS*dut.attribute_cache.ways[0].of_tags.BITS*dut.attribute_cache.ways[0].of_tags.WORDS
      + dut.attribute_cache.of_order.BITS*dut.attribute_cache.of_order.WORDS + $bits(dut.attribute_cache.valid));
    $display("levels of detail: %0d", LANES*dut.lane[0].walk.constants.lod.BITS*dut.lane[0].walk.constants.lod.WORDS);
  end
endmodule
