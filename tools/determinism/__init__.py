"""A campaign that looks for anything on which the bits of a run depend."""
