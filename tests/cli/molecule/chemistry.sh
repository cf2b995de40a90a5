# Wave numbers, names of bonds and of paths: `hapgrid molecule`'s modules against closed forms and the program xtb.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"
PYTHONPATH=$HAPGRID_BUILD/python /usr/bin/python3 "$here/chemistry.py" || fail "see above"
