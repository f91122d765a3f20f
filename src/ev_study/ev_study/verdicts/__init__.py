"""What each source published, how it is judged, and the verdicts that follow."""
