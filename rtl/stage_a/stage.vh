// Widths of stage A's records: eight vertices, the pool of all children's, and in screen space the box.
`define CAGE_WORDS 8
`define POOL_WORDS 27
`define MORE_BITS (1 + 4*W)
// Of an entry of the stack the level of the voxel, the pose, and what only one pose has.
`define REST_BITS ($clog2(DEPTH + 1) + 1 + 9*W)
// Registers of constants.
`define CONSTANTS 128
// A record may be no larger than a sample and lie across a bisector: whether it is hidden is searched.
`define SEARCHES 1
