// Widths of stage A's records: eight vertices, the pool, the screen-space box.
`define CAGE_WORDS 8
`define POOL_WORDS 27
`define MORE_BITS (1 + 4*W)
// As the model writes it: the box, and no planes.
`define FORM(more) more[4*W-1:0], {12*`WIDE_BITS{1'b0}}
// Rest of a stack entry: voxel level, screen-space flag, fields of one of the spaces.
`define REST_BITS ($clog2(DEPTH + 1) + 1 + 9*W)
`define JOINED_LEVELS 0
`define FILL_BITS(of) (of.fill_vectors.BITS*of.fill_vectors.WORDS)
`define STACK_LOG2 8
`define HAS_CONTEXTS 0
`define KEPT stacked
`define KEPT_BITS (STACK_LOG2 + 1)
`define CONSTANTS 128
