"""One module per role: importing it registers the methods that ev_sim has for the role."""
