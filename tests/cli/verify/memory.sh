#!/bin/bash
# verify --invariants has two layers of the grid in memory: not half of what the records' states take.
source "$(dirname "$0")/../lib.sh"
sanitized && skip "sanitizers cost memory"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins

# A state is 8 kB that nobody shares, 16,384 of them 134 MB.
cat >toy.toml <<'END'
grid = {origin = [0, 0, 0], spacing = 1, counts = [2, 2, 4096]}
model = {plugin = "toy", parameters = {state_size = 1000, amplitude = 1, tolerance = 1}}
seeds = {points = [[0, 0, 0]]}
END
seed toy.toml --set search.tears=false | expand --complete -o grid
peak() {
  python3 -c '
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1000)' "$@"
}
used=$(peak verify grid --invariants)
echo "verify --invariants: $used MB"
((used < 60)) || fail "verify --invariants took $used MB"
