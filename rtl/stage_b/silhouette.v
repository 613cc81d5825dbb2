`include "widths.vh"
// A cube's silhouette down the image quadtree: planes of its twelve edges, and one through the eye unless the cube is
// wholly in front of the eye. SPEC.md, 8.
//
// Quadrants derive from the constants `of_divided` of the node divided last. A plane whose side is known keeps its constant,
// which then fits the word, so sides are kept per level. `switch` saves all this, and restores that of context `next`.
module silhouette #(parameter W = `WORD_BITS, V = `WIDE_BITS, PICTURE_LEVELS = 10, CONTEXTS = 1, CONTEXT = 1) (
  input                        clk,
  input                        switch,
  input [CONTEXT-1:0]          running, next,
  input                        load,
  input [9*V-1:0]              edge_abc,    // along x, y, z
  input [6*V-1:0]              axis_ab,
  input [3*V-1:0]              axis_c,
  input [`LEVEL_BITS-1:0]      side,        // log2 of the cube's side
  input [3*W-1:0]              min, max, eye_floor, eye_ceil,
  input                        positive, before_eye,
  input                        divide, move, climb,
  input [`LEVEL_BITS-1:0]      level,
  input [1:0]                  quadrant,    // into which, or out of which
  output reg [`LEVEL_BITS-1:0] divided,     // level of the divided node
  input                        sample,      // the current node is one
  output [1:0]                 coverage);      // of it: 0 none, 1 some, 2 all
  localparam PLANES = 13;                   // the last is the plane through the eye

  wire [12*3*V-1:0] cube;
  cube_planes #(V) planes (.edge_x(edge_abc[6*V +: 3*V]), .edge_y(edge_abc[3*V +: 3*V]), .edge_z(edge_abc[0 +: 3*V]),
    .axis_x(axis_ab[4*V +: 2*V]), .axis_y(axis_ab[2*V +: 2*V]), .axis_z(axis_ab[0 +: 2*V]),
    .axis_x_c(axis_c[2*V +: V]), .axis_y_c(axis_c[V +: V]), .axis_z_c(axis_c[0 +: V]), .side(side),
    .plane_x0(cube[0 +: 3*V]), .plane_x1(cube[3*V +: 3*V]), .plane_x2(cube[6*V +: 3*V]), .plane_x3(cube[9*V +: 3*V]),
    .plane_y0(cube[12*V +: 3*V]), .plane_y1(cube[15*V +: 3*V]), .plane_y2(cube[18*V +: 3*V]),
    .plane_y3(cube[21*V +: 3*V]), .plane_z0(cube[24*V +: 3*V]), .plane_z1(cube[27*V +: 3*V]),
    .plane_z2(cube[30*V +: 3*V]), .plane_z3(cube[33*V +: 3*V]));
  wire front_found;
  wire [1:0] front_axis, front_side;
  cube_front #(W) of_front (.min(min), .max(max), .eye_floor(eye_floor), .eye_ceil(eye_ceil), .positive(positive),
    .found(front_found), .axis(front_axis), .side(front_side));
  wire [3*V-1:0] across = front_axis == 0 ? {axis_ab[4*V +: 2*V], axis_c[2*V +: V]} :
    front_axis == 1 ? {axis_ab[2*V +: 2*V], axis_c[V +: V]} : {axis_ab[0 +: 2*V], axis_c[0 +: V]};
  wire [PLANES*3*V-1:0] loaded = {across, cube};

  reg has_front;
  reg [1:0] wanted;                                        // side of the plane through the eye
  reg [2*PLANES-1:0] sides;                                // in the divided node
  reg [2*PLANES*(PICTURE_LEVELS + 1)-1:0] sides_of_level;  // in its divided ancestors
  wire [2*PLANES-1:0] sides_above = sides_of_level[2*PLANES*(divided - 1'b1) +: 2*PLANES];
  wire [2*PLANES-1:0] sides_here;
  genvar i;
  generate
    for (i = 0; i < PLANES; i = i + 1) begin : plane
      reg [V-1:0] a, b, of_divided, here;
      wire [V-1:0] inner;
      wire [1:0] found;
      plane_quadrant #(V) into (.plane({a, b, of_divided}), .quadrant(quadrant), .inner_c(inner));
      plane_side #(V) which (.plane({a, b, here}), .sample(sample), .side(found));
      wire known = |sides[2*i +: 2];
      assign sides_here[2*i +: 2] = known ? sides[2*i +: 2] : found;
      wire signed [V-1:0] doubled = of_divided - (quadrant[0] ? a : {V{1'b0}}) - (quadrant[1] ? b : {V{1'b0}});
      reg [4*V-1:0] kept [0:CONTEXTS-1];
      always @(posedge clk)
        if (switch) begin
          kept[running] <= {a, b, of_divided, here};
          {a, b, of_divided, here} <= kept[next];
        end else if (load) {a, b, here} <= loaded[3*V*i +: 3*V];
        else if (divide) of_divided <= here;
        else if (move) here <= known ? of_divided : inner;
        else if (climb & ~|sides_above[2*i +: 2]) of_divided <= doubled >>> 1;
    end
  endgenerate
  plane_cover of_sides (.side_x(sides_here[0 +: 8]), .side_y(sides_here[8 +: 8]), .side_z(sides_here[16 +: 8]),
    .front(has_front), .front_side(sides_here[24 +: 2]), .wanted(wanted), .cover_code(coverage));

  localparam KEPT = 3 + 2*PLANES + `LEVEL_BITS, SIDES = 2*PLANES*(PICTURE_LEVELS + 1);
  reg  [SIDES+KEPT-1:0] kept [0:CONTEXTS-1];
  wire [SIDES+KEPT-1:0] kept_of_next = kept[next];
  always @(posedge clk)
    if (switch) begin
      kept[running] <= {sides_of_level, has_front, wanted, sides, divided};
      {has_front, wanted, sides, divided} <= kept_of_next[KEPT-1:0];
      sides_of_level <= kept_of_next[KEPT +: SIDES];
    end else if (load) begin
      has_front <= ~before_eye & front_found;
      wanted <= front_side;
      sides <= 0;
    end else if (divide) begin
      divided <= level;
      sides <= sides_here;
      sides_of_level[2*PLANES*level +: 2*PLANES] <= sides_here;
    end else if (climb) begin
      divided <= divided - 1'b1;
      sides <= sides_above;
    end
endmodule
