"""What a run leaves: results and their files, statistics, spectra and tables of numbers."""
