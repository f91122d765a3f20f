"""The reports of single scenarios, each a module of the name of its scenario."""
