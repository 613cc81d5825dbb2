`include "widths.vh"
// A cache of words of 64 bits in lines of eight, set-associative, least recently used goes first.
//
// A request is answered in the next cycle on a hit: `ready` with `word`, until the next request. On a
// miss the line is asked for (`fetch` for one cycle), comes as eight words in order (`fill`), and `ready`
// follows in the cycle after the last.
module cache #(parameter SETS_LOG2 = 6, WAYS_LOG2 = 2) (
  input                       clk, reset,
  input                       request,
  input  [`NODE_BITS-1:0]     address,     // of a word
  output                      ready,
  output [63:0]               word,
  output                      fetch,
  output [`NODE_BITS-4:0]     fetch_line,
  input                       fill,
  input  [63:0]               fill_word);
  localparam WAYS = 1 << WAYS_LOG2, SETS = 1 << SETS_LOG2;
  localparam TAG = `NODE_BITS - 3 - SETS_LOG2;

  // What was asked for.
  reg                   looking, missing;
  reg [`NODE_BITS-1:0]  at;
  reg [2:0]             filled;
  wire [SETS_LOG2-1:0]  set = at[3 +: SETS_LOG2];
  wire [TAG-1:0]        tag = at[`NODE_BITS-1 -: TAG];

  // By set, the ways in order of use, the last used lowest; by set and way, tags and words.
  reg [SETS*WAYS*WAYS_LOG2-1:0] order;
  reg [SETS*WAYS-1:0]      valid;
  reg [TAG-1:0]            tags [0:SETS*WAYS-1];
  reg [63:0]               words [0:SETS*WAYS*8-1];

  // The way that has the line, and its place in the order.
  localparam ORDER = WAYS*WAYS_LOG2;
  wire [ORDER-1:0] now = order[set*ORDER +: ORDER];
  wire [WAYS-1:0]  valid_here = valid[set*WAYS +: WAYS];
  wire [WAYS-1:0] has;
  genvar i;
  generate
    for (i = 0; i < WAYS; i = i + 1) begin : look
      wire [WAYS_LOG2-1:0] way = now[i*WAYS_LOG2 +: WAYS_LOG2];
      assign has[i] = valid_here[way] & tags[{set, way}] == tag;
    end
  endgenerate
  wire hit = |has;
  reg [WAYS_LOG2-1:0] place;
  integer k;
  always @* begin
    place = WAYS - 1;     // on a miss the least recently used
    for (k = 0; k < WAYS; k = k + 1)
      if (has[k]) place = k;
  end
  wire [WAYS_LOG2-1:0] way = now[place*WAYS_LOG2 +: WAYS_LOG2];
  // That way comes first, those before it move on by one.
  reg [WAYS*WAYS_LOG2-1:0] used;
  always @* begin
    used = now;
    used[0 +: WAYS_LOG2] = way;
    for (k = 1; k < WAYS; k = k + 1)
      if (k <= place) used[k*WAYS_LOG2 +: WAYS_LOG2] = now[(k - 1)*WAYS_LOG2 +: WAYS_LOG2];
  end

  assign ready = looking & hit;
  assign word = words[{set, way, at[2:0]}];
  assign fetch = looking & ~hit & ~missing;
  assign fetch_line = at[`NODE_BITS-1:3];
  integer s;
  always @(posedge clk)
    if (reset) begin
      looking <= 0;
      missing <= 0;
      filled <= 0;
      valid <= 0;
      for (s = 0; s < SETS*WAYS; s = s + 1)
        order[s*WAYS_LOG2 +: WAYS_LOG2] <= s;   // modulo the ways
    end else begin
      if (request) begin
        looking <= 1;
        at <= address;
      end else if (ready)
        order[set*ORDER +: ORDER] <= used;
      if (fetch)
        missing <= 1;
      if (fill) begin
        words[{set, way, filled}] <= fill_word;
        filled <= filled + 1'b1;
        if (&filled) begin
          missing <= 0;
          valid[{set, way}] <= 1;
          tags[{set, way}] <= tag;
        end
      end
    end
endmodule
