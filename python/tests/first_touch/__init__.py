"""What a new user meets first: one test per trap that somebody fell into, each in the words of that user."""
