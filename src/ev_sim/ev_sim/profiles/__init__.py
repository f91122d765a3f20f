"""Values over time: speeds, pedals, hand torques and angles that are wanted, and the windows of a cycle."""
