"""Electric drives: a brushless DC motor, its converter and its current control, in three depths of detail."""
