"""What the commands share that make a grid: `hapgrid molecule`, `hapgrid table` and `hapgrid dock`.

cli       the command line, and failures as one line and an exit code
needs     what is looked for before anything begins
work      the folder of the results; what is there already is not computed again
grid      computing and verifying a grid in it
page      a play along a path, and the page that sums up (page.html)
programs  starting programs, and ending them with the command
files     files that are whole
pdb       alternate locations in PDB files
sandbox   where files from strangers are read: behind walls
texts     texts from outside on their way to a terminal
"""
