"""Methods of roles: declared, registered and stepped in plain Python."""
