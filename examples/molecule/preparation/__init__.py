"""From a molecule to the paths around its conformation, for `hapgrid molecule`.

elements    masses, radii, symbols
xtb         energies, gradients, Hessians
geometry    superposition, internal coordinates
optimise    minima and saddles
torsions    which torsions are driven, relaxed scans
path        steepest descent from a saddle, the nodes on it, and checks of them
molecule    a molecule and its conformers (RDKit)
beyond      the path of a torsion on behind its saddles
work        all steps for one molecule; each is kept
files       the files that are written
"""

import os
import sys

# One thread: these molecules are too small for more, and the order of a sum must not depend on the
# machine. OpenBLAS and OpenMP read this when they are loaded, so it must come before numpy.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"
sys.path.append(os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../command"))
