# play with a device that is a process: what it takes from an adapter, and how it ends when one lies,
# stalls, dies, or is not there.
source "$(dirname "$0")/../lib.sh"
stuck_grid 0
python3 "$here/process.py" before_the_loop in_the_loop
