"""The modules of `hapgrid molecule`; its --help says what it is for.

reading      a molecule from a file or SMILES; what cannot be felt is refused with what to do
pieces       which of several molecules is felt
rotors       which bonds turn, and their names
structures   the conformation, the saddles around it and the paths to them, in several processes
choice       the softest paths that are sane together
combined     what xtb says where minima of several paths are combined
stiffness    how stiff the anchors are, from the Hessian
definition   box and MODEL.toml
faults       what can be wrong with a grid, and what is done about it
resolution   a coarse grid, and the spacing that follows from it
pushing      the way of the probe that turns one torsion
crossing     its way over a barrier and back
curves       torsions and energies over time
page         plots, pictures and the page that sums up; page.html is its frame
steps        the steps one by one, from the molecule's file to the page
start        the first of them: the molecule
grids        and the longest: the grid
cli          the command line
"""
