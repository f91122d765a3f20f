"""Methods in compiled code: one part, and the loop over all parts of a graph."""
