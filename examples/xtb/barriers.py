"""Prints the barriers of HSSH through its trans and cis planes, for both methods of xtb, and the
time of an energy with its gradient. The barrier is the energy of planar HSSH with relaxed bonds
and angles, in kJ/mol above the twisted molecule. xtb writes to standard output, this to standard
error."""
import os
import sys
import time

import xtb_model

xyz = open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "disulfane.xyz")).read()
for method in "gfn2", "gfnff":
    model = xtb_model.ProbedMolecule(xyz, [0, 0, 0, 0], method)
    start = time.process_time()
    for _ in range(100):
        model.xtb(model.home)
    took_ms = 10 * (time.process_time() - start)
    print(method, took_ms, "ms for an energy and gradient", file=sys.stderr)
    model.anchor = [0, 1e5, 0] * 4  # holds the atoms in the plane y = 0
    model.home[1::3] = [0.0] * 4
    for x, plane in (-1.33, "trans"), (1.33, "cis"):
        model.home[9] = x
        energy = model.relax(model.home, [99.0] * 3, model.guess(model.home))[1]
        print(method, plane, energy, "kJ/mol", file=sys.stderr)
