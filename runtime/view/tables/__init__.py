"""Tables, as terminals print them and files keep them."""
