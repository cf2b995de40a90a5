"""The modules of `hapgrid molecule`; its --help says what it is for.

The command: cli, steps (one by one, from the molecule's file to the page), grids (the grid).

A molecule is read: reading, with formats, valences (what no file says of bonds, charges, hydrogens), building (shapes),
stereo (which isomer), molecule (what is read, and its conformers), elements.

Structures are found: structures (in several processes), search (each step), results (what they find, and how that is kept),
xtb (energies), geometry, optimise (minima and saddles), rotors (which bonds turn, and their names), torsions (scans), path
(to a saddle), torsion_paths (on behind saddles), ensemble (paths between given minima),
single_points (energies by other programs), xyz and files (what is written).

A grid is made: path_selection (the softest paths that are sane together), stiffness (of the anchors), definition (box and
MODEL.toml), resolution (the spacing).

The probe's way: probe_lines (turns a torsion, or leads over a barrier), page (page.html is its template).
"""

import os

# One thread: these molecules are too small for more, and the order of a sum must not depend on the
# machine. OpenBLAS and OpenMP read this when they are loaded, so it must come before numpy.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"
