"""Ge & Ni (2005): an electronic differential by slip targets of the rear wheels."""
