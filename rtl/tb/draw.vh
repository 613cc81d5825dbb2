// Reads the frame, opens files, writes constants, starts the machine.
$readmemh("frame.constants.hex", constants);
$readmemh("frame.nodes.hex", nodes);
pixels = $fopen("pixels.txt");
has_events = $test$plusargs("events");
events = 0;
if (has_events) events = $fopen("events.txt");
if ($value$plusargs("wave=%s", wave)) begin
  $dumpfile(wave);
  $dumpvars(`WATCHED, dut);
end
most = 100_000_000;
nothing = $value$plusargs("most=%d", most);
cycles = 0;
repeat (2) @(posedge clk);
#1 reset = 0;
for (i = 0; i < `CONSTANTS; i = i + 1) begin
  constant_write = 1;
  constant_address = i;
  constant_data = constants[i];
  @(posedge clk) #1;
end
constant_write = 0;
start = 1;
@(posedge clk) #1;
start = 0;
