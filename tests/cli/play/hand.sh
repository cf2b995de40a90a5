# A hand without a force: positions come through a named pipe, and the HIP lags behind them. The window that writes
# them is in cli/view/hand.sh.
source "$(dirname "$0")/../lib.sh"
[[ ${HAPGRID_WRAPPER-} ]] && skip "valgrind is too slow for 1000 ticks a second"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
python3 "$here/hand.py"

# What is wrong in the pipe is named, and the play has failed.
bad() { # TEXT MESSAGE
  (printf "$1" >hand & play grid --device path:hand) >/dev/null 2>err && fail "not refused"
  same "standard error" "~(play: .*"$'\n'")*play: device: hand: $2" "$(cat err)"
}
in_time err bad '0 0 0\n0 zero 0\n' "line 2: 'zero' is not a number"
in_time err bad '0 0' 'line 1: the 3 numbers x y z are needed, found 2'
# A pipe without a name has a whole path, as before.
play grid --device path:<(echo 0 0 0; echo 0.1 0 0) --log - 2>/dev/null | wc -l >lines
same "lines of the log" 3 "$(cat lines)"
rm hand
refuses 'play: hand: No such file or directory' -- play grid --device path:hand
