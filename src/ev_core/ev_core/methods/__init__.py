"""How a method of a role is declared, registered and stepped in plain Python."""
