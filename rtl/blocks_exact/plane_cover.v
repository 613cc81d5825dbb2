`include "widths.vh"
// A node's coverage, from the sides of a cube's planes: 0 none, 1 perhaps some, 2 all. SPEC.md, 8.
// Sides: four of two bits per edge direction.
module plane_cover (
  input  [7:0] side_x, side_y, side_z,
  input        front,
  input  [1:0] front_side, wanted,
  output [1:0] cover_code);
  function [1:0] passes(input [7:0] side);
    reg positive, negative, open;
    integer i;
    begin
      positive = 0;
      negative = 0;
      open = 0;
      for (i = 0; i < 4; i = i + 1) begin
        positive = positive | side[2*i +: 2] == 2'd1;
        negative = negative | side[2*i +: 2] == 2'd2;
        open = open | side[2*i +: 2] == 2'd0;
      end
      passes = {~(positive & negative) & ~open, positive & negative};
    end
  endfunction
  wire [1:0] x = passes(side_x), y = passes(side_y), z = passes(side_z);
  wire away = front & front_side != 2'd0 & front_side != wanted;
  wire none = x[1] | y[1] | z[1] | away;
  wire all  = x[0] & y[0] & z[0] & (~front | front_side == wanted);
  assign cover_code = none ? 2'd0 : all ? 2'd2 : 2'd1;
endmodule
