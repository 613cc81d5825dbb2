`include "widths.vh"
// Does a clip-space box leave a node by at most the node's width, along one axis? SPEC.md, 6.
module near_node #(parameter W = `WORD_BITS) (
  input [W-1:0]   x_corner, w_corner,
  input [3*W-1:0] x_edge, w_edge,
  output          near);
  wire [3*W-1:0] from_left, to_right;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      assign from_left[k*W +: W] = x_edge[k*W +: W] + w_edge[k*W +: W];
      assign to_right[k*W +: W]  = x_edge[k*W +: W] - (w_edge[k*W +: W] << 1);
    end
  endgenerate
  wire signed [W-1:0] low, high, a, b;
  child_span #(W) left  (.child_corner(x_corner + w_corner), .child_edge(from_left), .low(low), .high(a));
  child_span #(W) right (.child_corner(x_corner - (w_corner << 1)), .child_edge(to_right), .low(b), .high(high));
  assign near = low >= 0 & high <= 0;
endmodule
