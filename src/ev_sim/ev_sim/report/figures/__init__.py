"""Panels, sheets, maps and views.

All but `panels` import matplotlib, which takes longer than many a run: import them in the function that draws.
"""
