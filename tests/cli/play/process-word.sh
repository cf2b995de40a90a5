# play with a device that is a process: whoever of play, guard and adapter is killed, stopped or spins, the last thing that
# the device hears is zero force. And who shares a processor with whom.
source "$(dirname "$0")/../lib.sh"
stuck_grid 0
parts=(processor two_cores)
# Sanitizers and valgrind need more than there is then.
sanitized || parts+=(scarce)
python3 "$here/last_word.py" "${parts[@]}"
