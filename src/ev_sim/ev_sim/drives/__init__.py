"""Electric drives: a brushless DC motor, its converter and current control in three depths."""
