"""A source of your own: what it published, and how our runs are held against it."""
