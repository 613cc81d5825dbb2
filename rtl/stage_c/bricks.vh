// Bricks: a node two levels above the finest voxels has two words, a byte of voxels per child (their masks), then its first
// child and voxel. Counting earlier voxels gives a child's first one.
reg         laid_out;
reg [N-1:0] first_brick;
always @(posedge clk)
  if (constant_write)
    case (constant_address)
      8'd7: laid_out <= constant_data[4];
      8'd31: first_brick <= constant_data;
      default: ;
    endcase
wire has_bricks = BRICKS != 0 & laid_out;
// The current child is a brick, or the child of one.
wire is_brick = has_bricks & c_level + 2'd2 == depth;
wire in_brick = has_bricks & c_level + 1'b1 == depth;

// ---------------------------------------------------------------- its two words
reg  second;
wire reads_voxels = state == READ & node_ready & is_brick & ~second;
assign node_place = is_brick ? {c_node[N-2:0], 1'b0} - first_brick + second : c_node;
reg [63:0]  voxels;                             // of the brick that is subdivided or read
reg [N-1:0] first_voxel;
reg [2:0]   c_octant;                           // of the current child
wire [63:0]           p_voxels;
wire [NODE_WIDTH-1:0] p_first_voxel;
reg [64+N:0] brick_kept [0:CONTEXTS-1];
always @(posedge clk)
  if (switches) begin
    brick_kept[running] <= {second, voxels, first_voxel};
    {second, voxels, first_voxel} <= brick_kept[next_running];
  end else begin
    if (state == SOLID) second <= 0;
    else if (reads_voxels) second <= 1;
    if (reads_voxels) voxels <= node_word;
    else if (state == OPEN) voxels <= p_voxels;
    if (state == READ & second) first_voxel <= node_word[27:0];
    else if (state == OPEN) first_voxel <= p_first_voxel;
    if (state == CHILD) c_octant <= octant;
  end

function [7:0] children_in(input [63:0] bits);
  children_in = {|bits[63:56], |bits[55:48], |bits[47:40], |bits[39:32], |bits[31:24], |bits[23:16], |bits[15:8],
    |bits[7:0]};
endfunction
wire [7:0] c_mask;
wire [5:0] voxels_before;
brick_child of_brick (.voxels(voxels), .leaves(leaves), .octant(c_octant), .mask(c_mask), .earlier(voxels_before));
wire [47:0] c_of_node = in_brick ? {8'hff, c_mask, first_voxel + voxels_before} :
  is_brick ? {node_word[63:56], children_in(voxels), 4'd0, node_word[55:28]} : node_word[47:0];

// ---------------------------------------------------------------- on the stack
// A brick's voxels, or another node's mask.
localparam OF_NODE = BRICKS != 0 ? 64 + NODE_WIDTH + 8 : 16;
wire [OF_NODE-1:0] r_of_node, p_of_node;
wire [7:0] p_mask, p_leaves;
generate
  if (BRICKS != 0) begin : with_bricks
    wire r_is_brick = laid_out & r_level + 2'd2 == depth, p_is_brick = laid_out & p_level + 2'd2 == depth;
    assign r_of_node = {r_is_brick ? voxels : {56'd0, mask}, first_voxel[NODE_WIDTH-1:0], leaves};
    assign {p_voxels, p_first_voxel, p_leaves} = p_of_node;
    assign p_mask = p_is_brick ? children_in(p_voxels) : p_voxels[7:0];
  end else begin : without
    assign r_of_node = {mask, leaves};
    assign {p_mask, p_leaves} = p_of_node;
    assign {p_voxels, p_first_voxel} = 0;
  end
endgenerate
