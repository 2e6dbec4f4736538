"""What accuracy costs in time: bench -> reference -> points (errors, counts, times) -> record -> tables, figures."""
