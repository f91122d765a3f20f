"""Numbers over time, and single ones, that several reports derive from recorded channels."""
