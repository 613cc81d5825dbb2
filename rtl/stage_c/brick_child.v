// A brick's child: its mask, and the number of the brick's voxels before it. A leaf's byte is all ones, without voxels.
module brick_child (
  input  [63:0]    voxels,
  input  [7:0]     leaves,
  input  [2:0]     octant,
  output [7:0]     mask,
  output reg [5:0] earlier);
  assign mask = voxels[8*octant +: 8];
  wire [7:0] counted = ~leaves & ~(8'hff << octant);
  function [3:0] ones(input [7:0] bits);
    ones = bits[0] + bits[1] + bits[2] + bits[3] + bits[4] + bits[5] + bits[6] + bits[7];
  endfunction
  integer i;
  always @* begin
    earlier = 0;
    for (i = 0; i < 7; i = i + 1)
      earlier = earlier + ones(voxels[8*i +: 8] & {8{counted[i]}});
  end
endmodule
