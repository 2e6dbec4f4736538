"""Paper: Wu et al. 2021 reproduced on one page, what is printed, predicted and fitted kept apart."""
