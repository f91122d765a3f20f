"""Pictures of pages as a browser shows them, and the moving picture of the README."""
