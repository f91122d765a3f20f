"""Holding a method against the contract.

It has to be pure, deterministic and finite, with the same bits compiled and interpreted.
"""
