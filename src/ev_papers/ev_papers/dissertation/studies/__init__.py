"""Studies and reports of the dissertation: five methods, in simulation and on the bench."""
