import os
import sys

# What all commands that make grids share lies beside this folder.
sys.path.append(os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../command"))
