"""Panels, sheets, maps and views."""
