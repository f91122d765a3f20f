"""Values over time: speeds, pedals, hand torques and angles, and the windows of a cycle."""
