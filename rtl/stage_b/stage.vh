// Widths of stage B's records: a corner and three edges, the pool of all children's, and silhouette planes.
`define CAGE_WORDS 4
`define POOL_WORDS 11
`define MORE_BITS (12*V)
// Of an entry of the stack the depths, the least of them, and the planes.
`define REST_BITS (5*W + MORE)
// Log2 of the stack's entries.
`define STACK_LOG2 8
// Registers of constants.
`define CONSTANTS 164
