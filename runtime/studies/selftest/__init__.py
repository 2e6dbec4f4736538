"""Hard cases: where gear models usually break, each with what it must show, for every integrator."""
