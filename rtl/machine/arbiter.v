// First come, first served; of those that come in one cycle, the lowest number.
//
// Who asks keeps asking until it is granted, in a cycle with `enable`. `first` is the one that is next, granted or not.
module arbiter #(parameter N = 4) (
  input               clk, reset, enable,
  input  [N-1:0]      request,
  output reg [N-1:0]  first,
  output [N-1:0]      grant);
  // Who asked before this cycle, and was not granted; of two such, whether the lower number came first.
  reg [N-1:0]   waiting;
  reg [N*N-1:0] lower_first;
  reg [N*N-1:0] lower_now;
  integer i, j;
  always @* begin
    lower_now = 0;
    first = request;
    for (i = 0; i < N; i = i + 1)
      for (j = i + 1; j < N; j = j + 1) begin
        lower_now[i*N + j] = waiting[i] & waiting[j] ? lower_first[i*N + j] : waiting[i] | ~waiting[j];
        if (request[i] & request[j]) begin
          if (lower_now[i*N + j]) first[j] = 0;
          else first[i] = 0;
        end
      end
  end
  assign grant = first & {N{enable}};
  always @(posedge clk) begin
    lower_first <= lower_now;
    waiting <= reset ? {N{1'b0}} : request & ~grant;
  end
endmodule
