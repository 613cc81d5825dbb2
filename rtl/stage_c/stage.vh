// Widths of stage C's records: a corner and three edges, and silhouette planes.
`define CAGE_WORDS 4
`define MORE_BITS (12*V)
// Log2 of the stack's entries: a parent on each level.
`define STACK_LOG2 5
// Registers of constants.
`define CONSTANTS 164
