"""Values over time: speeds, pedals, hand torques and angles that somebody wants, and the windows of a cycle."""
