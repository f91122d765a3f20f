"""Closed courses: centre line and widths from a file, the line of least curvature, and the speed that a car can hold."""
