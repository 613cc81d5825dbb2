`include "widths.vh"
// Least and greatest vertex of a cage, one coordinate: its corner plus all negative or positive edges. SPEC.md, 4.
// Cage: the corner, highest, then edges along x, y, z.
module child_span #(parameter W = `WORD_BITS) (
  input  [4*W-1:0] child,
  output [W-1:0]   low, high);
  wire [3*W-1:0] below, above;
  genvar k;
  generate
    for (k = 0; k < 3; k = k + 1) begin : along
      wire [W-1:0] edge_k = child[k*W +: W];
      assign below[k*W +: W] = edge_k & {W{edge_k[W-1]}};
      assign above[k*W +: W] = edge_k & {W{~edge_k[W-1]}};
    end
  endgenerate
  wire [W-1:0] corner = child[3*W +: W];
  assign low  = corner + below[0 +: W] + below[W +: W] + below[2*W +: W];
  assign high = corner + above[0 +: W] + above[W +: W] + above[2*W +: W];
endmodule
