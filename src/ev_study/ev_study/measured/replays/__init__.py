"""Records replayed open loop, and how far the replay, or what estimators make of the record, is from it."""
