`include "widths.vh"
// Constants of the frame, written by the host before it. docs/rtl.md numbers the registers.
module frame_constants #(parameter W = `WORD_BITS) (
  input                         clk,
  input                         write,
  input  [7:0]                  address,
  input  [W-1:0]                data,
  output reg [`NODE_BITS-1:0]   root,
  output reg [`LEVEL_BITS-1:0]  levels,        // of the samples, in the image quadtree
  output reg [`LEVEL_BITS-1:0]  depth,         // of the finest voxels
  output reg [`LEVEL_BITS-1:0]  level_bound,   // of records
  output reg [`LEVEL_BITS-1:0]  sub_levels,    // below the finest voxels
  output reg [`PLACE_BITS-1:0]  width, height, // samples
  output reg                    coarse,        // level of detail draws all within a sample
  output [3*W-1:0]              origin,        // clip vector of the object's lowest corner: X, Y, W
  output [9*W-1:0]              edges,         // of its edges: X along x, y, z; Y; W
  output [3*W-1:0]              eye_floor,     // the eye in object space, rounded down
  output [3*W-1:0]              eye_ceil,      // and up
  output reg                    positive,      // the edges' clip vectors have a positive determinant
  output reg                    root_leaf,     // the object's node has no children
  output reg signed [W-1:0]     near, near_crossing,
  output reg signed [W-1:0]     size_limit, lod_limit, least_size, // screen-space sizes
  // Per octree level, a cycle after `look_up`: the least depth at which level of detail draws a node.
  input                         look_up,
  input  [`LEVEL_BITS-1:0]      of_level,
  output                        has_lod_depth,
  output signed [W-1:0]         lod_depth);
  reg [W-1:0] vector [0:14];  // origin, edges, eye
  reg [W-1:0] ceil [0:2];
  reg         has_lod;
  genvar i;
  generate
    for (i = 0; i < 3; i = i + 1) begin : three
      assign origin[(2 - i)*W +: W]    = vector[i];
      assign eye_floor[(2 - i)*W +: W] = vector[12 + i];
      assign eye_ceil[(2 - i)*W +: W]  = ceil[i];
    end
    for (i = 0; i < 9; i = i + 1) begin : nine
      assign edges[(8 - i)*W +: W] = vector[3 + i];
    end
  endgenerate
  wire [W-1:0] found;
  memory #(.BITS(W), .WORDS(64), .ADDRESS(6)) lod (.clk(clk), .read(look_up), .write(write & address[7:6] == 1),
    .address(look_up ? of_level : address[5:0]), .data_in(data), .data_out(found));
  assign has_lod_depth = has_lod & found != {1'b0, {(W-1){1'b1}}};
  assign lod_depth = found;
  always @(posedge clk)
    if (write & address[7:6] == 0)
        case (address[5:0])
          6'd0: root <= data;
          6'd1: levels <= data[`LEVEL_BITS-1:0];
          6'd2: depth <= data[`LEVEL_BITS-1:0];
          6'd3: level_bound <= data[`LEVEL_BITS-1:0];
          6'd4: sub_levels <= data[`LEVEL_BITS-1:0];
          6'd5: width <= data[`PLACE_BITS-1:0];
          6'd6: height <= data[`PLACE_BITS-1:0];
          6'd7: {root_leaf, positive, has_lod, coarse} <= data[3:0];
          6'd8: near <= data;
          6'd9: near_crossing <= data;
          6'd10: size_limit <= data;
          6'd11: lod_limit <= data;
          6'd12: least_size <= data;
          6'd13: ceil[0] <= data;
          6'd14: ceil[1] <= data;
          6'd15: ceil[2] <= data;
          default:
            if (address[5:0] >= 6'd16 && address[5:0] < 6'd31)
              vector[address[3:0]] <= data;
        endcase
endmodule
