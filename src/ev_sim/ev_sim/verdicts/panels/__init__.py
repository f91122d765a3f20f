"""The panels of each source's figures: one module for each source, whose PANELS are in the order of the source."""
