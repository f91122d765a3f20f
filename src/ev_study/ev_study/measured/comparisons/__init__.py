"""What is held against measured data and results of others: each comparison with its limit, and what drives it."""
