"""Holding a method against the contract: pure, deterministic, finite, the same bits compiled and interpreted."""
