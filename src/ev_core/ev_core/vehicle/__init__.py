"""The vehicle description that plant, column, driver and laws share, and what laws see of it."""
