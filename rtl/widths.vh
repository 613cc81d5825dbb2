// Widths in bits, for all modules; a tool's -D sets others. Generated headers define them before.
`ifndef WORD_BITS
  `define WORD_BITS 32
`endif
// Fraction bits of a screen position, at least 1.
`ifndef FRACTION_BITS
  `define FRACTION_BITS 16
`endif
// A level of the octree or of the image quadtree.
`define LEVEL_BITS 6
// A quadtree node's column or row.
`define PLACE_BITS 20
// An octree node.
`define NODE_BITS 32
// A number of a silhouette plane: twice a word, at most 64.
`ifndef WIDE_BITS
  `define WIDE_BITS 64
`endif
