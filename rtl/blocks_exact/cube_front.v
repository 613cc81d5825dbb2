`include "widths.vh"
// For a cube not wholly in front of the eye: the first axis along which the eye is outside, and the side of the plane
// across it from which rays arrive. SPEC.md, 8. Three words, x highest.
module cube_front #(parameter W = `WORD_BITS) (
  input  [3*W-1:0] min, max, eye_floor, eye_ceil,
  input            positive,
  output           found,
  output [1:0]     axis, side);
  wire [2:0] upwards, downwards;                 // bit 2 - axis
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire signed [W-1:0] low = min[k*W +: W], high = max[k*W +: W];
      wire signed [W-1:0] floor_k = eye_floor[k*W +: W], ceil_k = eye_ceil[k*W +: W];
      assign upwards[k]   = ceil_k <= low;
      assign downwards[k] = high <= floor_k;
    end
  endgenerate
  wire [2:0] beside = upwards | downwards;
  assign found = |beside;
  assign axis = beside[2] ? 2'd0 : beside[1] ? 2'd1 : beside[0] ? 2'd2 : 2'd0;
  wire up = beside[2] ? upwards[2] : beside[1] ? upwards[1] : upwards[0];
  assign side = ~found ? 2'd0 : up == positive ? 2'd1 : 2'd2;
endmodule
