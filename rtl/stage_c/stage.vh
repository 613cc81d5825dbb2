// Widths of stage C's records: a corner and three edges, and silhouette planes.
`define CAGE_WORDS 4
`define MORE_BITS (12*V)
// Lowest levels of fill vectors that are not in the memory of vectors, but joined to words.
`define JOINED_LEVELS 3
// All fill vectors, in bits, of a machine `dut`.
`define FILL_BITS (dut.fill_vectors.BITS*dut.fill_vectors.WORDS + dut.fill_words.BITS*dut.fill_words.WORDS)
// Log2 of the stack's entries: a parent on each level.
`define STACK_LOG2 5
// Registers of constants.
`define CONSTANTS 164
