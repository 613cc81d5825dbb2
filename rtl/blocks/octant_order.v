`include "widths.vh"
// The octant in which the eye sees a centre, and the octants of all children, the nearest highest. SPEC.md, 9.
module octant_order #(parameter W = `WORD_BITS) (
  input  [3*W-1:0] centre, eye_floor,
  output [2:0]     octant,
  output [23:0]    child);
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire signed [W-1:0] middle = centre[k*W +: W];
      wire signed [W-1:0] eye    = eye_floor[k*W +: W];
      assign octant[k] = eye < middle;
    end
  endgenerate
  assign child = {8{octant}} ^ {3'd7, 3'd6, 3'd5, 3'd3, 3'd4, 3'd2, 3'd1, 3'd0};
endmodule
