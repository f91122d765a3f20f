"""Commands about runs that were driven, and about what the sources published."""
