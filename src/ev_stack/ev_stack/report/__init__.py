"""The way from the recorded signals of a scenario to its summary, figures and printed table."""
