"""What commands share: how their words are read, and how they end."""
