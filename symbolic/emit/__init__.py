"""C text: a model's equations become functions, C and a manifest."""
