// Fill vectors of stage C: the lowest three levels are words with a bit per sample, the last of them in a register.
wire         joined = levels >= TILE_LEVELS + 2;  // the tile has these levels
wire [L-1:0] word_level = levels - 2'd2;
assign last_level = joined ? word_level : levels;
wire of_drawn = state == COVER | state == COVERED;

assign elsewhere = joined & fill_level >= word_level;
wire [L-1:0] below_word = fill_level - word_level;
wire [P-1:0] word_x = fill_x >> below_word, word_y = fill_y >> below_word;
localparam WORD_ADDRESS = 2*(PICTURE_LEVELS - TILE_LEVELS - 2) + CONTEXT_LOG2, WORDS = 32'd1 << WORD_ADDRESS;
wire [L-1:0] columns_log2 = word_level - TILE_LEVELS;
wire [P-1:0] row_in_tile = word_y & ~({P{1'b1}} << columns_log2);
wire [P-1:0] column_in_tile = word_x & ~({P{1'b1}} << columns_log2);
wire [WORD_ADDRESS-1:0] word_address = ((row_in_tile << columns_log2) + column_in_tile) << CONTEXT_LOG2 | running;
wire [15:0] word_there;
reg  [15:0] outside_word;
memory #(.BITS(16), .WORDS(WORDS), .ADDRESS(WORD_ADDRESS)) fill_words (.clk(clk),
  .read(fill_read & elsewhere & ~known), .write(fill_write & elsewhere), .address(word_address),
  .data_in(state == CLEAR ? outside_word : written), .data_out(word_there));

reg          has_word, is_written, marks_word, judged;
reg  [P-1:0] has_x, has_y;
reg  [15:0]  written;
wire [15:0]  word = is_written ? written : word_there;
assign known = has_word & elsewhere & has_x == word_x & has_y == word_y;
assign marked_all = marks_word ? &written : &marked;
reg [17 + 2*P:0] word_kept [0:CONTEXTS-1];
always @(posedge clk)
  if (switches) begin
    word_kept[running] <= {has_word, judged, has_x, has_y, word};
    {has_word, judged, has_x, has_y, written} <= word_kept[next_running];
    is_written <= 1;
  end else begin
    if (fill_read & elsewhere & ~known) begin
      {has_x, has_y} <= {word_x, word_y};
      has_word <= 1;
      is_written <= 0;
    end
    if (state == OBJECT | state == POP | state == OPEN | state == CENTRE | state == CHILD & judged) has_word <= 0;
    if (state == SOLID) judged <= 1;
    if (state == CHILD | state == CENTRE) judged <= 0;
    if (pixel & pixel_taken) begin
      written <= word | 16'd1 << {c_quad_y[1], c_quad_x[1], c_quad_y[0], c_quad_x[0]};
      is_written <= joined;
      marks_word <= joined;
    end
    if (state == MARK) marks_word <= 0;
  end

// The vector of a node of 16, 4 or 1 samples.
wire [3:0] quarter = word[4*{fill_y[0], fill_x[0]} +: 4];
wire [3:0] around = word[4*{fill_y[1], fill_x[1]} +: 4];
assign vector = ~elsewhere ? vector_there :
  below_word == 0 ? {&word[15:12], &word[11:8], &word[7:4], &word[3:0]} :
  below_word == 1 ? quarter : {4{around[{fill_y[0], fill_x[0]}]}};

// Initially set: samples outside the picture. Bits: row and column of the quadrant, then of the sample.
integer of_word;
always @*
  for (of_word = 0; of_word < 16; of_word = of_word + 1)
    outside_word[of_word] =
      {c_quad_x, of_word[2], of_word[0]} >= {2'b0, width} | {c_quad_y, of_word[3], of_word[1]} >= {2'b0, height};

task mark_sample;
  begin
    marked <= 4'b1111;
    if (joined) begin
      c_quad_level <= word_level;
      c_quad_x <= c_quad_x >> 2;
      c_quad_y <= c_quad_y >> 2;
    end
    state <= MARK;
  end
endtask
