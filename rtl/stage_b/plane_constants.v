`include "widths.vh"
// Constants of silhouette planes: registers from 128 on, two per number, low bits first.
module plane_constants #(parameter W = `WORD_BITS, V = `WIDE_BITS) (
  input            clk,
  input            write,
  input  [7:0]     address,
  input  [W-1:0]   data,
  output [6*V-1:0] axis_ab,   // a and b of the planes across x, y, z
  output [3*V-1:0] axis_c,    // their c at the root of the quadtree
  output [9*V-1:0] edge_abc); // the object's planes along x, y, z
  reg [W-1:0]   low  [0:17];
  reg [V-W-1:0] high [0:17];
  genvar i;
  generate
    for (i = 0; i < 3; i = i + 1) begin : axis
      assign axis_ab[(5 - 2*i)*V +: V] = {high[3*i], low[3*i]};
      assign axis_ab[(4 - 2*i)*V +: V] = {high[3*i + 1], low[3*i + 1]};
      assign axis_c[(2 - i)*V +: V]    = {high[3*i + 2], low[3*i + 2]};
    end
    for (i = 0; i < 9; i = i + 1) begin : along
      assign edge_abc[(8 - i)*V +: V] = {high[9 + i], low[9 + i]};
    end
  endgenerate
  always @(posedge clk)
    if (write & address[7])
      if (address[0]) high[address[5:1]] <= data[V-W-1:0];
      else low[address[5:1]] <= data;
endmodule
