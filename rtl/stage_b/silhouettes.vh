// Stages B and C: the current record's silhouette down the image quadtree.
wire             r_screen = 1'b0, c_screen = 1'b0;
wire [6*V-1:0]   axis_ab;
wire [3*V-1:0]   root_axis_c;
wire [9*V-1:0]   root_edges;
plane_constants #(W, V) of_planes (.clk(clk), .write(constant_write), .address(constant_address),
  .data(constant_data), .axis_ab(axis_ab), .axis_c(root_axis_c), .edge_abc(root_edges));
wire [MORE-1:0]  object_more = {root_edges, root_axis_c};

localparam SOLID = 32, QUADRANT = 33, COVER = 34, COVERED = 35, CLIMB = 36;

// ---------------------------------------------------------------- planes of a child, and in a quadrant
wire [MORE-1:0] child_more, inner_more;
child_planes #(V) of_child (.edge_x(r_more[9*V +: 3*V]), .edge_y(r_more[6*V +: 3*V]), .edge_z(r_more[3*V +: 3*V]),
  .axis_x(axis_ab[4*V +: 2*V]), .axis_y(axis_ab[2*V +: 2*V]), .axis_z(axis_ab[0 +: 2*V]),
  .axis_x_c(r_more[2*V +: V]), .axis_y_c(r_more[V +: V]), .axis_z_c(r_more[0 +: V]), .half(depth - r_level - 1'b1),
  .octant(octant), .child_edge_x(child_more[9*V +: 3*V]), .child_edge_y(child_more[6*V +: 3*V]),
  .child_edge_z(child_more[3*V +: 3*V]));
assign child_more[0 +: 3*V] = r_more[0 +: 3*V];
genvar e;
generate
  for (e = 0; e < 3; e = e + 1) begin : in_quadrant
    assign inner_more[(3*e + 4)*V +: 2*V] = c_more[(3*e + 4)*V +: 2*V];
    plane_quadrant #(V) of_edge (.plane(c_more[(3*e + 3)*V +: 3*V]), .quadrant(quadrant),
      .inner_c(inner_more[(3*e + 3)*V +: V]));
    plane_quadrant #(V) of_axis (.plane({axis_ab[2*e*V +: 2*V], c_more[e*V +: V]}), .quadrant(quadrant),
      .inner_c(inner_more[e*V +: V]));
  end
endgenerate

wire behind = w_high <= 0;
image_step #(W) box (.x(c_x), .y(c_y), .w(c_w), .below(levels - c_quad_level), .quadrant(quadrant),
  .outside(box_outside_now), .enclosed(box_enclosed), .overlapped(overlapped), .inner_x(inner_x),
  .inner_y(inner_y), .near(box_near));

reg [L-1:0] s_level;                            // the current node
reg [P-1:0] s_x, s_y;
reg         whole;                              // all samples of an ancestor are covered,
reg [L-1:0] whole_level;                        // on this level
wire [1:0]  side_coverage;
wire [1:0]  coverage = whole ? 2'd2 : side_coverage;
wire        sample = s_level == levels;
wire        looked = state == COVERED | state == COVER & known & coverage != 0 & ~(sample & ~looks);
wire        divides = looked & coverage == 1;
wire [L-1:0] divided;
wire [L-1:0] below_divided = s_level - divided;
wire [1:0]  s_quadrant = state == CLIMB ? {s_y[below_divided], s_x[below_divided]} : {s_y[0], s_x[0]};
silhouette #(W, V, PICTURE_LEVELS, CONTEXTS, BITS_OF_CONTEXT) outline (.clk(clk), .switch(switches),
  .running(running), .next(next_running), .load(state == SOLID), .edge_abc(t_more[3*V +: 9*V]),
  .axis_ab(axis_ab), .axis_c(t_more[0 +: 3*V]), .side(depth - t_level), .min(t_min), .max(t_max),
  .eye_floor(eye_floor), .eye_ceil(eye_ceil), .positive(positive), .before_eye(t_w_min > 0), .divide(divides),
  .move(state == QUADRANT), .climb(state == CLIMB), .level(s_level), .quadrant(s_quadrant), .divided(divided),
  .sample(sample), .coverage(side_coverage));
wire        draw_read = state == COVER & coverage != 0;
wire [L-1:0] draw_level = s_level;
wire [P-1:0] draw_x = s_x, draw_y = s_y;

wire [3:0]  rest = looked ? open : waiting[4*back_level +: 4];
wire [1:0]  next = rest[0] ? 2'd0 : rest[1] ? 2'd1 : rest[2] ? 2'd2 : 2'd3;
wire [L-1:0] next_in = looked ? s_level : back_level;
wire [L-1:0] s_up = s_level - next_in;
wire        still_whole = whole & next_in >= whole_level;
task next_quadrant;
  begin
    waiting[4*next_in +: 4] <= rest & (rest - 4'd1);
    s_level <= next_in + 1'b1;
    s_x <= {s_x >> s_up, next[0]};
    s_y <= {s_y >> s_up, next[1]};
  end
endtask

task draw_on;
  if (~back_any)
    state <= turn_over;
  else if (~still_whole & divided != back_level)
    state <= CLIMB;
  else begin
    next_quadrant;
    whole <= still_whole;
    state <= still_whole ? COVER : QUADRANT;
  end
endtask

// The node has quadrants that are not full, because it lies in one.
task divide_node;
  if (looks & coverage == 2)
    seen;
  else begin
    next_quadrant;
    if (~divides & ~whole) begin
      whole <= 1;
      whole_level <= s_level;
    end
    state <= divides ? QUADRANT : COVER;
  end
endtask
