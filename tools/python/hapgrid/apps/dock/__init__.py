"""The modules of `hapgrid dock`, from a host and a ligand to a grid in which the ligand turns; its --help says what it is for."""
