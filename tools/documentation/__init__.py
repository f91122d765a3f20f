"""The parts of docs/ that are drawn from the declarations, so that they cannot contradict the code."""
