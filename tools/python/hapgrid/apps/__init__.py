"""The programs in Python: `hapgrid molecule`, `hapgrid table`, `hapgrid dock` and `hapgrid plot`.

Each is `python3 -m hapgrid.apps.NAME`. The first three make grids, of what people already have; common has what they share.
xtb is the library of that name, which models of your own can use, too.
"""
