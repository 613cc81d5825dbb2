// LRU, the last used lowest: the way that has the line, or the least recently used one, and the order after its use.
module use_order #(parameter WAYS_LOG2 = 2, WAYS = 1 << WAYS_LOG2, ORDER = WAYS*WAYS_LOG2) (
  input [ORDER-1:0]         now,
  input [WAYS-1:0]          has_line,
  output [WAYS_LOG2-1:0]    way,
  output reg [ORDER-1:0]    used);
  reg [WAYS_LOG2-1:0] place;
  integer k;
  always @* begin
    place = WAYS - 1;
    for (k = 0; k < WAYS; k = k + 1)
      if (has_line[now[k*WAYS_LOG2 +: WAYS_LOG2]]) place = k;
  end
  assign way = now[place*WAYS_LOG2 +: WAYS_LOG2];
  always @* begin
    used = now;
    used[0 +: WAYS_LOG2] = way;
    for (k = 1; k < WAYS; k = k + 1)
      if (k <= place) used[k*WAYS_LOG2 +: WAYS_LOG2] = now[(k - 1)*WAYS_LOG2 +: WAYS_LOG2];
  end
endmodule
