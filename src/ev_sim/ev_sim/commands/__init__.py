"""What is started from a shell (scripts/*.sh)."""
