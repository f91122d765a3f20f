"""Cars and laws in C for machines without Python: libraries and FMUs with the same bits.

See docs/native.md.
"""
