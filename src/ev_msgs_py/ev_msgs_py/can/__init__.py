"""CAN frames of the bench: content, protection, length on the wire, and their database."""
