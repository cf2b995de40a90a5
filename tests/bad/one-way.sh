# A small shard with as many one-way links as there can be: each point has 254 levels, and all their links lead
# to level 0. It takes no more time to load than an honest one; and a signal ends the loading at once.
source "$(dirname "$0")/../cli/lib.sh"

seed "$ball" --set 'grid.counts=[5,5,4]' --set search.max_levels=254 | expand --complete -o honest
cat >craft.py <<'END'
import sys
sys.path.insert(0, sys.argv[1])
import shard
LEVELS = 254
messages = shard.decode(open("honest", "rb").read())
box = messages[0]["header"]["box"]
before = messages[1]["records"]
points = range(box["countX"] * box["countY"] * box["countZ"])
records = len(points) * LEVELS
rows = {
    "point": [p for p in points for _ in range(LEVELS)],
    "level": [level for _ in points for level in range(LEVELS)],
    "generation": [0] * records,
    "state": [0.0] * (records * len(before["state"]) // len(before["point"])),
    "links": [255 if shard.neighbour(box, p, q) is None else 0
              for p in points for _ in range(LEVELS) for q in range(26)],
}
messages[0]["header"].update(generation=1)
messages[1:-1] = [{"records": rows}]
open("one-way", "wb").write(shard.seal(messages))
END
python3 craft.py "$HAPGRID_SOURCE/tests/cli"
(($(stat -c %s one-way) < 100000)) || fail "it is not small"
printf '%s\n' '-0.95 -0.45 -0.45' '-0.9 -0.44 -0.44' >path

seconds() { python3 -c 'import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stderr=open("stderr", "w"))
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime)' "$@"; }
used=$(seconds play one-way --device path:path) || fail "$(cat stderr)"
limit=$(sanitized && echo 30 || echo 3)
awk -v used="$used" -v limit="$limit" 'BEGIN { exit !(used < limit) }' || fail "$used CPU s"

# The grid comes through a pipe that stays open, so that the signal finds play while it loads.
mkfifo pipe
for signal in INT:130 TERM:143; do
  env --default-signal=INT,TERM play pipe --device path:path 2>stderr &
  exec 3>pipe
  kill "-${signal%:*}" $!
  code=0
  wait $! || code=$?
  exec 3>&-
  [ "$code" = "${signal#*:}" ] || fail "$signal: exit $code: $(cat stderr)"
done
