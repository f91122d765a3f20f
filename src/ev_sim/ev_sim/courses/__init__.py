"""Closed courses, the line of least curvature on them, and the speed that a car can hold."""
