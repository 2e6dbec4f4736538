"""Many runs: sweeps, sensitivities, accuracy against time, the self-test, the paper of Wu et al. 2021."""
