# merge and expand --complete hold the records of the grid once, and a part of expand holds some
# thousand of them.
source "$(dirname "$0")/../lib.sh"
sanitized && skip "sanitizers cost memory"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins

# Seeds at every third point along each axis: the others are reached in one generation, from up to
# eight seeds each. The model's states do not compress, so the shards are as large as they get.
python3 - >lattice.toml <<'END'
third = range(1, 48, 3)
print("""model = {plugin = "toy", parameters = {state_size = 100, amplitude = 0}}
grid = {origin = [0, 0, 0], spacing = 1, counts = [48, 48, 48]}
seeds.points =""", [[i, j, k] for k in third for j in third for i in third])
END
seed lattice.toml -o grid
whole=$((48 ** 3 * (8 * 100 + 4 + 4 + 1 + 26) / 1000000)) # MB of records

# takes MB COMMAND...: fails when its peak memory is larger.
takes() {
  local used
  used=$(python3 -c '
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1000)' "${@:2}")
  echo "${*:2}: $used MB"
  ((used <= $1)) || fail "${*:2} took $used MB, more than $1"
}
takes $((whole * 14 / 10)) expand --complete grid -o complete
expand grid -j 2 -o requests
takes $((whole * 14 / 10)) merge grid requests -o next
cmp -s grid next && fail "nothing was merged"

# Requests of many parts that lie side by side: a chunk of each is in memory.
takes $((whole / 2)) expand next --part 3/8 -o part
for k in {1..60}; do expand next --part "$k/60" -o "part.$k"; done
takes $((whole * 15 / 10)) merge next part.* -o after
rm part*; expand after | merge after - | cmp - complete
