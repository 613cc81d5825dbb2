// A single-port memory. Data follows `read` by one cycle.
module memory #(parameter BITS = 4, WORDS = 16, ADDRESS = 4) (
  input                  clk, read, write,
  input  [ADDRESS-1:0]   address,
  input  [BITS-1:0]      data_in,
  output reg [BITS-1:0]  data_out);
  reg [BITS-1:0] words [0:WORDS-1];
  always @(posedge clk)
    if (write)
      words[address] <= data_in;
    else if (read)
      data_out <= words[address];
endmodule
