"""One module per role: importing it registers the methods that ev_bench has for the role."""
