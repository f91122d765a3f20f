"""Parameters as data: declared once in frozen dataclasses, checked, read from files."""
