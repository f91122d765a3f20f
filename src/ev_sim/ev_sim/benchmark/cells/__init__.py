"""The runs of the cells of a board: what is alike in them, what is drawn, how they are driven and kept."""
