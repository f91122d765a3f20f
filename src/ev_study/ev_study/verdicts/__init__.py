"""Published numbers of each source, their judgement, and the verdicts that follow."""
