"""Page of Wu et al. 2021 reproduced: printed, predicted and fitted numbers apart."""
