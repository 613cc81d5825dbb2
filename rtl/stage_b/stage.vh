// Widths of stage B's records: a corner and three edges, the pool of all children's, and silhouette planes.
`define CAGE_WORDS 4
`define POOL_WORDS 11
`define MORE_BITS (12*V)
// Of an entry of the stack the depths, the least of them, and the planes.
`define REST_BITS (5*W + MORE)
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
`define CONSTANTS 164
