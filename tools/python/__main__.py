"""Starts a program of the package hapgrid.apps by its name, as `python3 -E FOLDER molecule ...`: Python looks for modules in the
folder that it is started with, and so finds the package that lies beside this file."""

import runpy
import sys

OTHERS = {"single-point-ase": "molecule.single_point_ase"}
name = sys.argv.pop(1)
runpy.run_module(f"hapgrid.apps.{OTHERS.get(name, name)}", run_name="__main__")
