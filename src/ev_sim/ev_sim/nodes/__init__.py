"""The executables of ev_sim, one module each."""
