"""The compiled loop that takes the ordinary steps of a node with a process to itself."""
