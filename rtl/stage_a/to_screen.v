`include "widths.vh"
// Changes a record to screen space: sixteen dividers, one per vertex and coordinate, then the move to the node's place.
// Results are valid from the cycle after `last`. SPEC.md, 5.
module to_screen #(parameter W = `WORD_BITS, F = `FRACTION_BITS) (
  input                    clk, start,
  input  [8*W-1:0]         x, y, w,
  input  [`LEVEL_BITS-1:0] below,
  input  [`PLACE_BITS-1:0] node_x, node_y,
  output                   last,
  output [8*W-1:0]         screen_x, screen_y);
  wire [`LEVEL_BITS-1:0] fraction_bits = below + F;
  wire step, fraction;
  wire [1:0] place;
  divide_control control (.clk(clk), .start(start), .fraction_bits(fraction_bits), .step(step),
                          .place(place), .fraction(fraction), .last(last));
  wire [W-1:0] column = node_x, row = node_y;
  wire [W-1:0] left = (column - 4) << below << F;
  wire [W-1:0] top  = (row - 4) << below << F;
  genvar v;
  generate
    for (v = 0; v < 8; v = v + 1) begin : vertex
      wire [W-1:0] across, down;
      divide_lane #(W) of_x (.clk(clk), .load(start), .step(step), .place(place), .fraction(fraction),
                             .x(x[v*W +: W]), .w(w[v*W +: W]), .quotient(across));
      divide_lane #(W) of_y (.clk(clk), .load(start), .step(step), .place(place), .fraction(fraction),
                             .x(y[v*W +: W]), .w(w[v*W +: W]), .quotient(down));
      assign screen_x[v*W +: W] = across + left;
      assign screen_y[v*W +: W] = down + top;
    end
  endgenerate
endmodule
