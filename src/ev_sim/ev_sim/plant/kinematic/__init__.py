"""Shchur's traction model: a point mass on wheels that roll without slip (Shchur 2019, eqs 8 to 13)."""
