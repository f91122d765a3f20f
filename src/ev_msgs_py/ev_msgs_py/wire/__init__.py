"""Frames as messages: serialized templates with the numbers of the frame at fixed places."""
