"""Controller's end of the CAN bus: set-points out, feedback in, drives led through states."""
