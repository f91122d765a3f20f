"""Words and ends that commands share."""
