// Writes `picture` as picture.png, uncompressed.
integer png, bit_of, column, row;
reg [31:0] check, sum_low, sum_high;             // CRC of a chunk; Adler's sums of the data
task put(input [7:0] value);
  begin
    $fwrite(png, "%c", value);
    check = check ^ value;
    for (bit_of = 0; bit_of < 8; bit_of = bit_of + 1) check = check >> 1 ^ (check[0] ? 32'hedb88320 : 0);
  end
endtask
task put_word(input [31:0] value);
  begin
    put(value[31:24]);
    put(value[23:16]);
    put(value[15:8]);
    put(value[7:0]);
  end
endtask
task put_data(input [7:0] value);
  begin
    put(value);
    sum_low = (sum_low + value) % 65521;
    sum_high = (sum_high + sum_low) % 65521;
  end
endtask
task begin_chunk(input [31:0] bytes, input [31:0] name);
  begin
    put_word(bytes);
    check = ~0;
    put_word(name);
  end
endtask
task put_picture(input [15:0] width, input [15:0] height);
  reg [15:0] bytes;                              // of a row and its filter
  begin
    bytes = 3*width + 1;
    png = $fopen("picture.png", "wb");
    put_word(32'h89504e47);
    put_word(32'h0d0a1a0a);
    begin_chunk(13, "IHDR");
    put_word(width);
    put_word(height);
    put_word(32'h08020000);                      // 8 bits, RGB
    put(0);
    put_word(~check);
    begin_chunk((bytes + 5)*height + 6, "IDAT");
    put(8'h78);
    put(8'h01);
    {sum_low, sum_high} = {32'd1, 32'd0};
    for (row = 0; row < height; row = row + 1) begin
      put(row + 1 == height);
      put(bytes[7:0]);
      put(bytes[15:8]);
      put(~bytes[7:0]);
      put(~bytes[15:8]);
      put_data(0);
      for (column = 0; column < 3*width; column = column + 1)
        put_data(picture[row*width + column/3] >> 8*(2 - column % 3));
    end
    put_word(sum_high << 16 | sum_low);
    put_word(~check);
    begin_chunk(0, "IEND");
    put_word(~check);
    $fclose(png);
  end
endtask
