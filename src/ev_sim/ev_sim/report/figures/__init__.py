"""Panels, sheets, maps and views: everything that imports matplotlib."""
