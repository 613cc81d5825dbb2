`include "stage.vh"
// Prints the bits of the machine's memories under the model's names. A cache's valid bits are registers; they count with
// the tags, as in the model.
module memories_tb #(parameter PICTURE_LEVELS = 8, LEVEL_BOUND = 30, DEPTH = LEVEL_BOUND, NODE_WIDTH = 32,
                     BRICKS = 0);
  reg clk, reset, constant_write, start, fill;
  reg [7:0] constant_address;
  reg [31:0] constant_data;
  reg [63:0] fill_word;
  machine #(.PICTURE_LEVELS(PICTURE_LEVELS), .LEVEL_BOUND(LEVEL_BOUND), .DEPTH(DEPTH), .NODE_WIDTH(NODE_WIDTH),
            .BRICKS(BRICKS)) dut (
    .clk(clk), .reset(reset), .constant_write(constant_write), .constant_address(constant_address),
    .constant_data(constant_data), .start(start), .fill(fill), .fill_word(fill_word));
  initial begin
    $display("record stack: %0d", dut.stack.BITS*dut.stack.WORDS);
    $display("fill vectors: %0d", `FILL_BITS(dut));
    $display("node cache: %0d",
      dut.own.node_cache.WAYS*dut.own.node_cache.ways[0].of_words.BITS*dut.own.node_cache.ways[0].of_words.WORDS);
    $display("node cache, tags: %0d",
      dut.own.node_cache.WAYS*dut.own.node_cache.ways[0].of_tags.BITS*dut.own.node_cache.ways[0].of_tags.WORDS
      + dut.own.node_cache.of_order.BITS*dut.own.node_cache.of_order.WORDS + $bits(dut.own.node_cache.valid));
    $display("attribute cache: %0d", dut.own.attribute_cache.WAYS*dut.own.attribute_cache.ways[0].of_words.BITS
      *dut.own.attribute_cache.ways[0].of_words.WORDS);
    $display("attribute cache, tags: %0d",
      dut.own.attribute_cache.WAYS*dut.own.attribute_cache.ways[0].of_tags.BITS*dut.own.attribute_cache.ways[0].of_tags.WORDS
      + dut.own.attribute_cache.of_order.BITS*dut.own.attribute_cache.of_order.WORDS + $bits(dut.own.attribute_cache.valid));
    // Not in the model: depths of level of detail, a word per level.
    $display("levels of detail: %0d", dut.constants.lod.BITS*dut.constants.lod.WORDS);
  end
endmodule
