"""What the program `prepare` consists of; its --help says what it is for.

xtb         energies, gradients, Hessians
geometry    superposition, internal coordinates
optimise    minima and saddles
torsions    which torsions are driven, relaxed scans
path        steepest descent from a saddle, nodes, whether they are sane
molecule    reading molecules, conformers (Open Babel)
work        one molecule from start to end, each step kept until all are done
files       what is written
cli         the command line
"""

import os

# One thread: these molecules are too small for more, and the order of a sum must not depend on the
# machine. OpenBLAS and OpenMP read this when they are loaded, so it comes before numpy.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"
