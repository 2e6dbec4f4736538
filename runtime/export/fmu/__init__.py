"""FMU: a scene as one file for other simulation programs (FMI 2.0 and 3.0)."""
