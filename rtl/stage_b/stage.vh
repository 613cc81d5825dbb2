// Widths of stage B's records: a corner and three edges, the pool, silhouette planes.
`define CAGE_WORDS 4
`define POOL_WORDS 11
`define MORE_BITS (12*V)
// As the model writes it: no box in screen space, and the planes.
`define FORM(more) {4*W{1'b0}}, more
// Rest of a stack entry: depths, the least depth, planes.
`define REST_BITS (5*W + MORE)
`define JOINED_LEVELS 0
`define FILL_BITS(of) (of.fill_vectors.BITS*of.fill_vectors.WORDS)
`define STACK_LOG2 8
`define HAS_CONTEXTS 0
`define KEPT stacked
`define KEPT_BITS (STACK_LOG2 + 1)
`define CONSTANTS 164
