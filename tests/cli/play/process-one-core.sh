# play with a device that is a process, all on one core: the table of process-word.sh.
source "$(dirname "$0")/../lib.sh"
stuck_grid 0
python3 "$here/last_word.py" one_core
