`include "widths.vh"
// Overlapped quadrants, bit y << 1 | x, from halves along both axes. SPEC.md, 6.
module quadrants (
  input        low_half_x, high_half_x, low_half_y, high_half_y,
  output [3:0] overlapped);
  wire [1:0] across = {high_half_x, low_half_x};
  assign overlapped = {across & {2{high_half_y}}, across & {2{low_half_y}}};
endmodule
