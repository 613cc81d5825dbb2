`include "widths.vh"
// Rejects a box whose overlapped quadrants are full, or selects its only quadrant. SPEC.md, 6.
module node_choice (
  input  [3:0] overlapped, vector,
  output       rejected, single,
  output [1:0] quadrant);
  assign rejected = ~|(overlapped & ~vector);
  assign single   = |overlapped & ~|(overlapped & (overlapped - 4'd1));
  assign quadrant = single ? {overlapped[3] | overlapped[2], overlapped[3] | overlapped[1]} : 2'd0;
endmodule
