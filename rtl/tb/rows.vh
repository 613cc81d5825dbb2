// A module `BENCH runs `BLOCK through the rows of `ROWS, a file of model --vectors with `INTO and `OUT bits, and prints how
// many were wrong. A `CLOCKED block takes cycles from `start` to `last`.
`define READ $fscanf(file, "{\"in\":\"%h\",\"out\":\"%h\"}\n", row, expected) == 2
module `BENCH;
  reg [`INTO-1:0] row;
  reg [`OUT-1:0] expected;
  wire [`OUT-1:0] result;
  reg clk = 0, start = 0;
  wire last;
  integer file, at = 0, wrong = 0;
  `BLOCK dut (`PORTS);
  initial begin
    file = $fopen(`ROWS, "r");
    while (`READ) begin
`ifdef CLOCKED
      start = 1; #1 clk = 1; #1 clk = 0; start = 0;
      while (!last) begin #1 clk = 1; #1 clk = 0; end
      #1 clk = 1; #1 clk = 0;
`else
      #1;
`endif
      if (result !== expected) wrong = wrong + 1;
      at = at + 1;
    end
    $display("%m: %0d of %0d", wrong, at);
  end
endmodule
