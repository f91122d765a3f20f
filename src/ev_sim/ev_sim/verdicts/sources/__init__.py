"""One module, or package, for each source: its DECLARATIONS judge the ids of the list of the same name."""
