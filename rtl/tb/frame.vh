// Common to testbenches of frames: counts cycles and writes pixels.
integer events, pixels, i, cycles, most, nothing;
reg has_events;
reg [8*32-1:0] wave;
function [31:0] place(input [31:0] level, input [31:0] x, input [31:0] y);
  place = ((1 << 2*level) - 1)/3 + (y << level) + x;
endfunction
function [7:0] nearest_lowest(input [7:0] left);
  nearest_lowest = {left[0], left[1], left[2], left[3], left[4], left[5], left[6], left[7]};
endfunction
always @(posedge clk) if (busy & ~reset) begin
  cycles <= cycles + 1;
  if (pixel) $fwrite(pixels, "%0d %0d %0d %0d %0d %0d\n", pixel_y * constants[5] + pixel_x, pixel_node,
    pixel_voxel[2*W +: W], pixel_voxel[W +: W], pixel_voxel[0 +: W], pixel_level);
  if (pixel && pixel_attribute != `ATTRIBUTE(pixel_node)) begin
    $display("the attributes of node %0d came with a pixel of node %0d", pixel_attribute, pixel_node);
    $finish;
  end
end
