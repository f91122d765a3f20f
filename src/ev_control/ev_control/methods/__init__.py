"""One module per role: importing it registers the methods that ev_control has for the role."""
