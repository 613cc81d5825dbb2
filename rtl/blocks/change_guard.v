`include "widths.vh"
// May a box change to screen space: x and w - x at least -w / 2^places at all vertices, on one axis? SPEC.md, 5.
module change_guard #(parameter W = `WORD_BITS) (
  input [8*W-1:0]    x, w,
  input signed [7:0] places,
  output             enclosed);
  wire [7:0] up   = places[7] ? 8'd0 : places;
  wire [7:0] down = places[7] ? -places : 8'd0;
  wire [7:0] beyond_left, beyond_right;
  genvar i;
  generate
    for (i = 0; i < 8; i = i + 1) begin : vertex
      wire [W-1:0] at    = x[i*W +: W];
      wire [W-1:0] wide  = w[i*W +: W];
      wire [W-1:0] guard = wide << down;
      wire [W-1:0] rest  = wide - at;
      wire [W-1:0] left  = (at << up) + guard;
      wire [W-1:0] right = (rest << up) + guard;
      assign beyond_left[i]  = left[W-1];
      assign beyond_right[i] = right[W-1];
    end
  endgenerate
  assign enclosed = ~|beyond_left & ~|beyond_right;
endmodule
