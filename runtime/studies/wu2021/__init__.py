"""Wu et al. 2021: comparison of its 2 MW rig with the printed results."""
