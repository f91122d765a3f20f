"""What speaks on the CAN bus for the controller: set-points out, feedback in, drives led through their states."""
