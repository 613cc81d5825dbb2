`include "children_steps.vh"
`include "silhouette_steps.vh"
