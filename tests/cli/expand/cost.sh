# What differs from run to run goes to --cost, as one JSON line.
source "$(dirname "$0")/../lib.sh"

seed "$ball" --set 'grid.counts=[2,2,2]' -o seeds
expect 0 '' '' -- expand seeds --cost costs -o r1
expect 0 '' '' -- expand seeds --part 2/3 --cost costs -j 2 -o r2
expect 0 '' '' -- expand --complete seeds --cost costs -o grid
expect 0 '' '' -- merge seeds r1 --cost costs -o next
python3 - costs <<'END'
import json, socket, sys
lines = open(sys.argv[1]).read().splitlines()
costs = [json.loads(line) for line in lines]
keys = ["tool", "generation", "part", "parts", "conversions", "wall_seconds", "cpu_seconds", "host"]
for cost in costs:
    assert list(cost) == keys, cost
    assert 0 < cost["wall_seconds"] < 600 and 0 < cost["cpu_seconds"] < 600, cost
    assert cost["host"] == socket.gethostname(), cost
# 8 points, each a corner: 7 conversions; --complete counts those of all generations.
what = [[r[k] for k in keys[:5]] for r in costs]
assert what == [["expand", 0, 1, 1, 56], ["expand", 0, 2, 3, 19], ["expand", 0, 1, 1, 56],
                ["merge", 1, 1, 1, 0]], what
END

# A run that failed adds no line; a line that cannot be written is a failure.
expect 1 '' '~expand: .*' -- expand nix --cost other
[[ ! -e other ]] || fail "a cost of a run that failed"
# Where the model ended it, there is a line that says why.
seed "$ball" --set 'grid.counts=[40,6,6]' --set 'grid.origin=[-0.975,-0.125,-0.125]' --set search.max_levels=1 -o limited
refuses 'expand: level limit: .*' -- expand --complete limited --cost failed -o r3
same "why" levels "$(sed -n 's/.*"failed":"\([a-z]*\)".*/\1/p' failed)"
refuses 'expand: missing/costs: No such file or directory' -- expand seeds --cost missing/costs -o r3
refuses 'expand: /dev/full: No space left on device' -- expand seeds --cost /dev/full -o r3

# Lines of processes that share the file stay whole.
seq 40 | xargs -P 8 -I{} expand seeds --part {}/40 --cost shared -o /dev/null
same "lines" 40 "$(wc -l <shared)"
python3 -c '
import json
print(sorted(json.loads(line)["part"] for line in open("shared")) == list(range(1, 41)))' >sorted
same "parts" True "$(cat sorted)"

# A file system that has no locks.
if strace -o /dev/null true 2>/dev/null && ! sanitized; then
  for error in ENOLCK ENOSYS; do
    expect 0 '' '~expand: unlocked cannot be locked \([A-Z].*\): let one process at a time write there' -- \
      strace -f -qq -o trace -e inject=flock:error=$error expand seeds --cost unlocked -o r4
  done
  same "lines" 2 "$(wc -l <unlocked)"
fi
