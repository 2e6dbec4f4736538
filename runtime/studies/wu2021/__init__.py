"""Wu et al. 2021: what its 2 MW rig shows beside what was printed."""
