// Widths of stage C's records: a corner and three edges, silhouette planes.
`define CAGE_WORDS 4
`define MORE_BITS (12*V)
// As the model writes it: no box in screen space, and the planes.
`define FORM(more) {4*W{1'b0}}, more
// Lowest levels whose fill vectors are joined to words.
`define JOINED_LEVELS 3
`define FILL_BITS(of) (of.fill_vectors.BITS*of.fill_vectors.WORDS + of.fill_words.BITS*of.fill_words.WORDS)
// One parent per level.
`define STACK_LOG2 5
`define HAS_CONTEXTS 1
`define KEPT stacked, r_inside, r_level, r_quad_level, r_quad_x, r_quad_y, r_min, r_max, r_x, r_y, r_w, r_more, \
  c_inside, c_level, c_quad_level, c_node, c_quad_x, c_quad_y, c_min, c_max, c_x, c_y, c_w, c_w_min, c_more, \
  middle, leaves, mask, first, order, left, s_level, s_x, s_y, whole, whole_level, draws
`define KEPT_BITS (STACK_LOG2 + 6*L + 6*P + 2*N + 16*W + 6*CAGE + 2*MORE + 53)
`define CONSTANTS 164
