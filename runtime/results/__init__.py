"""Results of runs: quantities with units, files, statistics, spectra and tables."""
