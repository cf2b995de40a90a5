# The angle along y = z = 0, there and back, against the closed form: on a grid that has the planes
# y = z = 0, where a single cell is torn at each end, and on the shipped one, which has them between its
# planes, so that the planes at -h/2 and h/2 are torn in different cells.
source "$(dirname "$0")/../lib.sh"

path=$HAPGRID_SOURCE/examples/hung-ball/path-there-and-back.txt
seed "$ball" | expand --complete -o shipped.grid
seed "$ball" --set 'grid.counts=[41,21,21]' --set 'grid.origin=[-1,-0.5,-0.5]' |
  expand --complete -o plane.grid
play shipped.grid --device "path:$path" --log shipped.log 2>/dev/null
play plane.grid --device "path:$path" --log plane.log 2>/dev/null
python3 "$here/along.py" shipped.log 0.05 0.025 3
python3 "$here/along.py" plane.log 0.05 0 1
