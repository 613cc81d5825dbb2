`include "children_events.vh"
