"""From the recorded signals of a scenario to its summary, its figures and its printed table."""
