"""Models for hapgrid in Python, and its files as arrays of NumPy.

serve() lets hapgrid use a model, relax() goes downhill in energy to the next minimum, search() makes a grid, read() gives
what a grid, a session, a log or a file of frames holds, hapgrid.plot draws them, and write_vti() writes an image for
ParaView. normalised(), applied() and turned() help with orientations. The module itself needs the standard library alone;
read() and write_vti() need NumPy, and hapgrid.plot matplotlib.

Debian's package puts this module where python3 finds it; filters put it in the PYTHONPATH of the models that they start.
Elsewhere PYTHONPATH is "$(hapgrid bin)/../python".
"""
from hapgrid import plot
from hapgrid.files import read, write_vti
from hapgrid.orientations import applied, normalised, turned
from hapgrid.relaxation import relax
from hapgrid.searching import search
from hapgrid.serving import serve

__all__ = ["applied", "normalised", "plot", "read", "relax", "search", "serve", "turned", "write_vti"]
__version__ = "@PROJECT_VERSION@"
