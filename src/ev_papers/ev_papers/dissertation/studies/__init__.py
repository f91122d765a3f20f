"""The studies and reports of the dissertation: five methods in its urban cycle, in simulation and on the bench."""
