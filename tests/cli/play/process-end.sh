# play with a device that is a process: however play ends, the adapter hears zero force last, and ends.
source "$(dirname "$0")/../lib.sh"
stuck_grid 0
stuck_grid 1
python3 "$here/process.py" at_the_end play_ends real_time
