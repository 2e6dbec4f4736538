"""Small motions: the generated model linearised about an operating point, and what follows from it."""
