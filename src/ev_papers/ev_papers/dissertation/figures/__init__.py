"""The figures of the dissertation and of its urban cycle, drawn from our runs."""
