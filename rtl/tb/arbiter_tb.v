// Random requests, some of them right after a grant; counts grants out of order.
module arbiter_tb #(parameter N = 4);
  reg clk = 0, reset = 1, enable = 0;
  reg [N-1:0] request = 0;
  wire [N-1:0] first, grant;
  arbiter #(N) dut (.clk(clk), .reset(reset), .enable(enable), .request(request), .first(first), .grant(grant));
  integer since [0:N-1];
  integer now, i, next, wrong;
  reg [N-1:0] granted;
  initial begin
    wrong = 0;
    #1 clk = 1;
    #1 clk = 0;
    reset = 0;
    for (now = 0; now < 4000; now = now + 1) begin
      for (i = 0; i < N; i = i + 1)
        if (~request[i] & $urandom % 3 == 0) begin
          request[i] = 1;
          since[i] = now;
        end
      enable = $urandom % 2;
      next = -1;
      for (i = 0; i < N; i = i + 1)
        if (request[i] && (next < 0 || since[i] < since[next])) next = i;
      #1;
      if (first !== (next < 0 ? {N{1'b0}} : 1 << next) || grant !== (enable ? first : {N{1'b0}})) wrong = wrong + 1;
      granted = grant;
      #1 clk = 1;
      #1 clk = 0;
      request = request & ~granted;
    end
    $display("%0d wrong", wrong);
  end
endmodule
