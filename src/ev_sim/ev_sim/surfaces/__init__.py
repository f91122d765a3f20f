"""Roads: surfaces along each track and the slope, as functions of travelled distance."""
