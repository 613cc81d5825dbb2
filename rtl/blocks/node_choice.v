`include "widths.vh"
// Overlapped quadrants and a node's fill vector to: rejected, or the one quadrant to go on in. SPEC.md, 6.
module node_choice (
  input  [3:0] overlapped, vector,
  output       rejected, single,
  output [1:0] quadrant);
  assign rejected = ~|(overlapped & ~vector);
  assign single   = |overlapped & ~|(overlapped & (overlapped - 4'd1));
  assign quadrant = single ? {overlapped[3] | overlapped[2], overlapped[3] | overlapped[1]} : 2'd0;
endmodule
