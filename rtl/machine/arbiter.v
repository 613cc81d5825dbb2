// Grants requests in order of arrival, of equals the lowest number first. A request stays until its grant, which needs
// `enable`.
module arbiter #(parameter N = 4) (
  input               clk, reset, enable,
  input  [N-1:0]      request,
  output reg [N-1:0]  first,
  output [N-1:0]      grant);
  // Earlier requests without a grant; per pair, whether the lower number came first.
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
