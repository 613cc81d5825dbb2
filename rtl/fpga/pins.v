`include "widths.vh"
`include "stage.vh"
// The machine behind four pins, for place and route: it has more ports than a chip has pins. Its inputs come from a shift
// register, its outputs leave by another.
module pins #(parameter W = `WORD_BITS, PICTURE_LEVELS = 8) (
  input      clk, data_in, load,
  output reg data_out);
  localparam IN = 4 + 8 + W + 64, OUT = 6 + `NODE_BITS - 3 + 2*`PLACE_BITS + `NODE_BITS + 3*W + `LEVEL_BITS + 64;
  reg [IN-1:0]  in;
  reg [OUT-1:0] out;
  wire busy, done, failed, fetch, fetch_attribute, pixel;
  wire [`NODE_BITS-4:0]  fetch_line;
  wire [`PLACE_BITS-1:0] pixel_x, pixel_y;
  wire [`NODE_BITS-1:0]  pixel_node;
  wire [3*W-1:0]         pixel_voxel;
  wire [`LEVEL_BITS-1:0] pixel_level;
  wire [63:0]            pixel_attribute;
  machine #(.PICTURE_LEVELS(PICTURE_LEVELS)) dut (
    .clk(clk), .reset(in[0]), .start(in[1]), .fill(in[2]), .constant_write(in[3]), .constant_address(in[4 +: 8]),
    .constant_data(in[12 +: W]), .fill_word(in[12 + W +: 64]),
    .busy(busy), .done(done), .failed(failed), .fetch(fetch), .fetch_attribute(fetch_attribute),
    .fetch_line(fetch_line), .pixel(pixel), .pixel_x(pixel_x), .pixel_y(pixel_y), .pixel_node(pixel_node),
    .pixel_voxel(pixel_voxel), .pixel_level(pixel_level), .pixel_attribute(pixel_attribute));
  always @(posedge clk) begin
    in <= {in, data_in};
    out <= load ? {busy, done, failed, fetch, fetch_attribute, fetch_line, pixel, pixel_x, pixel_y, pixel_node,
      pixel_voxel, pixel_level, pixel_attribute} : {out, 1'b0};
    data_out <= out[OUT-1];
  end
endmodule
