"""A driver who looks ahead: gains from the car's own model, steering by them, and a speed for each bend."""
