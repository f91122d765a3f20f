"""Claims of papers on torque vectoring, of which the abstract alone could be read, on our cars."""
