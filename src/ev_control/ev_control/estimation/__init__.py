"""What the laws have to estimate because no sensor of a car measures it."""
