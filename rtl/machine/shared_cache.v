`include "widths.vh"
// As cache.v, for several users (contexts of lanes). Requests are `taken` in order of arrival. A request to a line in flight
// merges with that miss.
//
// An access takes two cycles, for single-port memories: one reads, the other writes the order of use or sends the miss,
// until `fetch_taken`. No access begins while a line arrives.
module shared_cache #(parameter USERS = 4, SETS_LOG2 = 6, WAYS_LOG2 = 2, ADDRESS = 29) (
  input                     clk, reset,
  input  [USERS-1:0]        request,
  input  [USERS*ADDRESS-1:0] address,      // of a word
  output [USERS-1:0]        taken, ready,
  output [USERS*64-1:0]     word,
  output                    fetch,
  input                     fetch_taken,
  output [ADDRESS-4:0]      fetch_line,
  input                     fill,
  input  [63:0]             fill_word);
  localparam WAYS = 1 << WAYS_LOG2, SETS = 1 << SETS_LOG2;
  localparam TAG = ADDRESS - 3 - SETS_LOG2;
  localparam ORDER = WAYS*WAYS_LOG2;
  // Lines in flight: at most one per user.
  localparam E = USERS > 1 ? $clog2(USERS) : 1, ENTRIES = 1 << E;

  reg                 looking;              // an access is in its second cycle
  wire                look = |taken;
  wire [USERS-1:0]    unused_first;
  arbiter #(USERS) turns (.clk(clk), .reset(reset), .enable(~looking & ~fill & filled == 0), .request(request),
    .first(unused_first), .grant(taken));
  reg [ADDRESS-1:0]   address_now;
  integer n;
  always @* begin
    address_now = 0;
    for (n = 0; n < USERS; n = n + 1)
      address_now = address_now | address[n*ADDRESS +: ADDRESS] & {ADDRESS{taken[n]}};
  end
  reg [ADDRESS-1:0]   at;
  reg [USERS-1:0]     of;                   // the user
  wire [SETS_LOG2-1:0] set = at[3 +: SETS_LOG2];
  wire [TAG-1:0]      tag = at[ADDRESS-1 -: TAG];

  // ---------------------------------------------------------------- lines in flight
  reg [ADDRESS-4:0]   entry_line [0:ENTRIES-1];
  reg [WAYS_LOG2-1:0] entry_way [0:ENTRIES-1];
  reg [E-1:0]         oldest;
  reg [E:0]           entries;
  wire [E-1:0]        next_entry = oldest + entries[E-1:0];
  reg [2:0]           filled;
  wire                last_fill = fill & &filled;
  wire [ADDRESS-4:0]  filled_line = entry_line[oldest];
  wire [WAYS_LOG2-1:0] filled_way = entry_way[oldest];

  // ---------------------------------------------------------------- tags, words, order of use
  reg [SETS*WAYS-1:0] valid;
  wire [WAYS-1:0]     valid_here = valid[set*WAYS +: WAYS];
  wire [ORDER-1:0]    stored, unused;
  wire [ORDER-1:0]    now = |valid_here ? stored : unused;
  wire [WAYS*TAG-1:0] tags;
  wire [WAYS*64-1:0]  words;
  wire [WAYS-1:0]     has_line;
  wire [WAYS_LOG2-1:0] way;
  wire [ORDER-1:0]    used;
  wire                hit = |has_line;
  assign fetch = looking & ~hit;
  genvar i;
  generate
    for (i = 0; i < WAYS; i = i + 1) begin : ways
      assign unused[i*WAYS_LOG2 +: WAYS_LOG2] = i;
      memory #(.BITS(TAG), .WORDS(SETS), .ADDRESS(SETS_LOG2)) of_tags (.clk(clk), .read(look),
        .write(fetch & fetch_taken & way == i), .address(look ? address_now[3 +: SETS_LOG2] : set), .data_in(tag),
        .data_out(tags[i*TAG +: TAG]));
      memory #(.BITS(64), .WORDS(8*SETS), .ADDRESS(3 + SETS_LOG2)) of_words (.clk(clk), .read(look),
        .write(fill & filled_way == i),
        .address(fill ? {filled_line[SETS_LOG2-1:0], filled} : address_now[2+SETS_LOG2:0]), .data_in(fill_word),
        .data_out(words[i*64 +: 64]));
      assign has_line[i] = valid_here[i] & tags[i*TAG +: TAG] == tag;
    end
  endgenerate
  use_order #(WAYS_LOG2) ways_used (.now(now), .has_line(has_line), .way(way), .used(used));
  memory #(.BITS(ORDER), .WORDS(SETS), .ADDRESS(SETS_LOG2)) of_order (.clk(clk), .read(look),
    .write(looking & (hit | fetch_taken)), .address(look ? address_now[3 +: SETS_LOG2] : set), .data_in(used),
    .data_out(stored));

  // Is the hit line in flight? Its last entry counts.
  reg         on_its_way;
  reg [E-1:0] entry;
  integer k;
  always @* begin
    on_its_way = 0;
    entry = next_entry;
    for (k = 0; k < USERS; k = k + 1)
      if (hit & k < entries & entry_line[(oldest + k) % ENTRIES] == at[ADDRESS-1:3]
          & entry_way[(oldest + k) % ENTRIES] == way) begin
        on_its_way = 1;
        entry = oldest + k;
      end
  end
  wire begins_to_wait = looking & (hit ? on_its_way : fetch_taken);
  wire found = looking & hit & ~on_its_way;
  wire [63:0] found_word = words[way*64 +: 64];
  assign fetch_line = at[ADDRESS-1:3];
  generate
    for (i = 0; i < USERS; i = i + 1) begin : user
      reg            waits, arrived;
      reg [E-1:0]    waits_for;
      reg [2:0]      wanted;
      reg [63:0] kept;
      wire begins = begins_to_wait & of[i];
      wire [E-1:0] line = waits ? waits_for : entry;
      wire [2:0] place = waits ? wanted : at[2:0];
      assign ready[i] = found & of[i] | arrived;
      assign word[i*64 +: 64] = found & of[i] ? found_word : kept;
      always @(posedge clk) begin
        if (found & of[i]) kept <= found_word;
        else if (fill & (waits | begins) & line == oldest & place == filled) kept <= fill_word;
        if (begins) {waits_for, wanted} <= {entry, at[2:0]};
        arrived <= ~reset & last_fill & waits & waits_for == oldest;
        if (reset | last_fill & waits & waits_for == oldest) waits <= 0;
        else if (begins) waits <= 1;
      end
    end
  endgenerate

  always @(posedge clk)
    if (reset) begin
      looking <= 0;
      oldest <= 0;
      entries <= 0;
      filled <= 0;
      valid <= 0;
    end else begin
      looking <= look | fetch & ~fetch_taken;
      if (look) {at, of} <= {address_now, taken};
      if (fetch & fetch_taken) begin
        entry_line[next_entry] <= fetch_line;
        entry_way[next_entry] <= way;
        valid[{set, way}] <= 1;
      end
      if (fill) filled <= filled + 1'b1;
      if (last_fill) oldest <= oldest + 1'b1;
      entries <= entries + (fetch & fetch_taken) - last_fill;
    end
endmodule
