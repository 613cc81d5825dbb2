// Widths of stage A's records: eight vertices, the pool of all children's, and in screen space the box.
`define CAGE_WORDS 8
`define POOL_WORDS 27
`define MORE_BITS (1 + 4*W)
// Of an entry of the stack the level of the voxel, the pose, and what only one pose has.
`define REST_BITS ($clog2(DEPTH + 1) + 1 + 9*W)
// Lowest levels of fill vectors that are not in the memory of vectors.
`define JOINED_LEVELS 0
// All fill vectors, in bits, of a machine.
`define FILL_BITS(of) (of.fill_vectors.BITS*of.fill_vectors.WORDS)
// Log2 of the stack's entries.
`define STACK_LOG2 8
// What a context has in registers, and its bits: there is one only.
`define HAS_CONTEXTS 0
`define KEPT stacked
`define KEPT_BITS (STACK_LOG2 + 1)
// Registers of constants.
`define CONSTANTS 128
