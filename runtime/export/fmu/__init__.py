"""FMU: a scene as one file for other simulation programs, by the standards FMI 2.0 and 3.0."""
