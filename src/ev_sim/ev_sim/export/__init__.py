"""Cars and laws in C, for machines without Python: libraries with the same bits (docs/native.md)."""
