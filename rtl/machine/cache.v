`include "widths.vh"
// A set-associative LRU cache of 64-bit words in lines of eight.
//
// A hit is `ready` with `word` in the next cycle, until the next request. A miss raises `fetch` for one cycle. Its eight
// words arrive in order (`fill`), and the request is looked up again. Requests are at least two cycles apart.
module cache #(parameter SETS_LOG2 = 6, WAYS_LOG2 = 2, ADDRESS = 29) (
  input                       clk, reset,
  input                       request,
  input  [ADDRESS-1:0]        address,     // of a word
  output                      ready,
  output [63:0]               word,
  output                      fetch,
  output [ADDRESS-4:0]        fetch_line,
  input                       fill,
  input  [63:0]               fill_word);
  localparam WAYS = 1 << WAYS_LOG2, SETS = 1 << SETS_LOG2;
  localparam TAG = ADDRESS - 3 - SETS_LOG2;
  localparam ORDER = WAYS*WAYS_LOG2;

  reg                   looking, missing, again;
  reg [ADDRESS-1:0]     at;
  reg [2:0]             filled;
  wire [SETS_LOG2-1:0]  set = at[3 +: SETS_LOG2];
  wire [TAG-1:0]        tag = at[ADDRESS-1 -: TAG];

  // Per set, the ways in order of use, the last used lowest.
  wire look = request | again;
  reg                   looked;      // in the cycle before
  reg [SETS*WAYS-1:0]   valid;
  wire [WAYS-1:0]       valid_here = valid[set*WAYS +: WAYS];
  wire [ORDER-1:0]      stored, unused;
  wire [ORDER-1:0]      now = |valid_here ? stored : unused;

  wire last_fill = fill & &filled;
  wire [2+SETS_LOG2:0] look_at = request ? address[2+SETS_LOG2:0] : at[2+SETS_LOG2:0];
  wire [2+SETS_LOG2:0] fill_at = {set, filled};
  wire [WAYS*TAG-1:0]  tags;
  wire [WAYS*64-1:0]   words;
  wire [WAYS-1:0]      has_line;
  genvar i;
  generate
    for (i = 0; i < WAYS; i = i + 1) begin : ways
      assign unused[i*WAYS_LOG2 +: WAYS_LOG2] = i;
      wire mine = way == i;
      memory #(.BITS(TAG), .WORDS(SETS), .ADDRESS(SETS_LOG2)) of_tags (.clk(clk), .read(look),
        .write(last_fill & mine), .address(fill ? set : look_at[3 +: SETS_LOG2]), .data_in(tag),
        .data_out(tags[i*TAG +: TAG]));
      memory #(.BITS(64), .WORDS(8*SETS), .ADDRESS(3 + SETS_LOG2)) of_words (.clk(clk), .read(look),
        .write(fill & mine), .address(fill ? fill_at : look_at), .data_in(fill_word),
        .data_out(words[i*64 +: 64]));
      assign has_line[i] = valid_here[i] & tags[i*TAG +: TAG] == tag;
    end
  endgenerate

  wire hit = |has_line;
  wire [WAYS_LOG2-1:0] way;
  wire [ORDER-1:0]     used;
  use_order #(WAYS_LOG2) ways_used (.now(now), .has_line(has_line), .way(way), .used(used));

  memory #(.BITS(ORDER), .WORDS(SETS), .ADDRESS(SETS_LOG2)) of_order (.clk(clk), .read(look),
    .write(looked & hit | last_fill), .address(look ? look_at[3 +: SETS_LOG2] : set), .data_in(used),
    .data_out(stored));

  assign ready = looking & hit & ~missing;
  assign word = words[way*64 +: 64];
  assign fetch = looking & ~hit & ~missing;
  assign fetch_line = at[ADDRESS-1:3];
  always @(posedge clk)
    if (reset) begin
      looking <= 0;
      missing <= 0;
      again <= 0;
      filled <= 0;
      valid <= 0;
      looked <= 0;
    end else begin
      again <= last_fill;
      looked <= look;
      if (request) begin
        looking <= 1;
        at <= address;
      end
      if (fetch)
        missing <= 1;
      else if (again)
        missing <= 0;
      if (fill)
        filled <= filled + 1'b1;
      if (last_fill)
        valid[{set, way}] <= 1;
    end
endmodule
