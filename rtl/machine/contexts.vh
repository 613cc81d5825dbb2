// While context `running` waits for a cache or a tile, the one whose answer or tile came first takes over, of equals the
// lowest. Registers of the others are saved: `KEPT`, and by parts of the stage.
wire [CONTEXTS-1:0] runs = 1 << running;
reg  [CONTEXTS-1:0] idle, begun;                // others: without a tile; with a tile not begun
reg  [CONTEXTS-1:0] asks_node, asks_attribute;  // others: not taken yet
reg  [CONTEXTS-1:0] answered;                   // not read yet
wire                has_no_tile = state == IDLE | state == DONE;
wire                looks_at_answer = state == LOOK | state == SHOW;
wire                starts = |(start & runs);
wire [CONTEXTS-1:0] wants = ~runs & (answered | shared_node_ready | shared_attribute_ready | begun | start);
wire                waits = has_no_tile & ~starts | state == NODE | state == ATTRIBUTE
                            | looks_at_answer & ~node_ready & ~attribute_ready;
wire [CONTEXTS-1:0] unused_first, next_runs;
wire                switches = |next_runs;
reg  [BITS_OF_CONTEXT-1:0] next_running;
wire                next_begins = |(next_runs & (begun | start));
wire [5:0]          state_then = state == NODE ? LOOK : state == ATTRIBUTE ? SHOW : state;
generate
  // Invalid parameters: an undefined module stops the build.
  if (CONTEXTS > 1 && (SHARED == 0 || `HAS_CONTEXTS == 0 || CONTEXTS != 1 << CONTEXT_LOG2)) begin : refused
    contexts_are_a_power_of_two_in_lanes_of_stage_c error();
  end
  if (CONTEXTS > 1) begin : several
    arbiter #(CONTEXTS) turns (.clk(clk), .reset(reset), .enable(waits), .request(wants), .first(unused_first),
      .grant(next_runs));
  end else begin : only_one
    assign next_runs = 1'b0;
  end
endgenerate

wire [N-1:0] wanted = state == NODE ? node_place : t_node;
reg [N-1:0] wanted_by [0:CONTEXTS-1];
integer of_context;
always @* begin
  next_running = 0;
  {tile_x_now, tile_y_now, node_word_now, attribute_word_now} = 0;
  for (of_context = 0; of_context < CONTEXTS; of_context = of_context + 1) begin
    if (next_runs[of_context]) next_running = of_context;
    if (runs[of_context]) begin
      tile_x_now = tile_x[of_context*P +: P];
      tile_y_now = tile_y[of_context*P +: P];
      node_word_now = shared_node_word[of_context*64 +: 64];
      attribute_word_now = shared_attribute_word[of_context*64 +: 64];
    end
  end
end
genvar number;
generate
  for (number = 0; number < CONTEXTS; number = number + 1) begin : of_each
    assign node_request[number] = runs[number] ? state == NODE : asks_node[number];
    assign attribute_request[number] = runs[number] ? state == ATTRIBUTE : asks_attribute[number];
    assign wanted_node[number*N +: N] = runs[number] ? wanted : wanted_by[number];
    assign busy[number] = runs[number] ? ~has_no_tile : ~idle[number];
  end
endgenerate

always @(posedge clk)
  if (reset) begin
    running <= 0;
    idle <= {CONTEXTS{1'b1}};
    {begun, asks_node, asks_attribute, answered} <= 0;
  end else begin
    idle <= idle & ~start | (switches & has_no_tile ? runs : {CONTEXTS{1'b0}});
    begun <= (begun | start) & ~runs;
    asks_node <= (switches & state == NODE ? asks_node | runs : asks_node) & ~shared_node_taken;
    asks_attribute <= (switches & state == ATTRIBUTE ? asks_attribute | runs : asks_attribute)
      & ~shared_attribute_taken;
    answered <= (answered | shared_node_ready | shared_attribute_ready) & ~(looks_at_answer ? runs : {CONTEXTS{1'b0}});
    if (switches) begin
      running <= next_running;
      wanted_by[running] <= wanted;
    end
  end

// For testbenches: one cycle per request.
wire asked_node = state == NODE & (node_taken | switches);
wire asked_attribute = state == ATTRIBUTE & (attribute_taken | switches);
