"""What the recorder of a run and its runner leave in the folder of the run, by name."""

BAG = "bag"
SIGNALS = "signals.npz"
PARAMETERS = "parameters.yaml"
