"""The modules of `hapgrid table`, from a table of energies to a grid of it; its --help says what it is for."""
