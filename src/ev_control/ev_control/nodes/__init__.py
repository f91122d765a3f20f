"""The executables of ev_control, one module each."""
