"""What a paper prints or what follows from its equations: the numbers that a run is compared with."""
