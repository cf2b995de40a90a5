# What the haptic thread asks of the system between its first tick and its last: the time to sleep
# until, and nothing else, with log, frames and all; with each device (device.sh has those of HID).
source "$(dirname "$0")/../lib.sh"
[[ ${HAPGRID_WRAPPER-} ]] && skip "valgrind makes calls of its own"
! grep -q '^HAPGRID_SANITIZE:STRING=thread' "$HAPGRID_BUILD/CMakeCache.txt" || skip "the thread sanitizer has locks, for which threads wait"
export ASAN_OPTIONS=detect_leaks=0  # which needs ptrace for itself
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90} {90..-90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
common=(--rate 500 --frames frames --report report)
trace() { # NAME COMMAND...
  strace -f -o "trace.$1" "${@:2}" >/dev/null 2>err || fail "$1: $(cat err)"
}
trace path play grid --device path:path --log log "${common[@]}"
trace session play grid --device path:path --log log.session "${common[@]}"
trace replay play grid --device replay:log.session "${common[@]}"
cat >keys.sh <<END
strace -f -o trace.keys play grid --device keys --duration 2 ${common[*]} 2>err
END
script -qec 'bash keys.sh' /dev/null </dev/null >/dev/null || fail "keys: $(cat err)"
PYTHONPATH=$here python3 -c 'import sys, system_calls; [system_calls.check(name) for name in sys.argv[1:]]' trace.*
