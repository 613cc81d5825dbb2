// Widths in bits. A tool's -D or a generated header overrides those with `ifndef.
`ifndef WORD_BITS
  `define WORD_BITS 32
`endif
// Fraction bits of a screen position, at least 1.
`ifndef FRACTION_BITS
  `define FRACTION_BITS 16
`endif
// Octree or quadtree level.
`define LEVEL_BITS 6
// Column or row of a quadtree node.
`define PLACE_BITS 20
// Octree node.
`define NODE_BITS 32
// Number of a silhouette plane: twice a word, at most 64.
`ifndef WIDE_BITS
  `define WIDE_BITS 64
`endif
