# merge streams: under 200 MB on 128^3 points (issue 2), in a generation that touches every point
# and has more requests than any of the hung ball's.
source "$(dirname "$0")/../lib.sh"
sanitized && skip "sanitizers cost memory"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins

# Seeds at every third point along each axis: the others are reached in one generation, from up to
# eight seeds each. The model's states do not compress, so the shards are as large as they get.
python3 - >lattice.toml <<'END'
print("""[model]
plugin = "toy"
parameters = {amplitude = 1, tolerance = 0.4}
[grid]
origin = [0, 0, 0]
spacing = 1
counts = [128, 128, 128]
[seeds]
points = [""")
for k in range(1, 128, 3):
    for j in range(1, 128, 3):
        print("".join("[%d,%d,%d]," % (i, j, k) for i in range(1, 128, 3)))
print("]")
END
seed lattice.toml -o grid

# peak FILE COMMAND...: the command's peak memory in MB.
peak() {
  python3 -c '
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1000)' "$@"
}
expand grid -j 2 -o requests
requests=$(stats --get conversions_left grid)
((requests > 2000000)) || fail "only $requests requests"
used=$(peak merge grid requests -o next)
echo "merge of $requests requests: $used MB"
((used < 200)) || fail "merge took $used MB"

# expand streams too.
used=$(peak expand next --part 3/8 -o part)
echo "expand of a part: $used MB"
((used < 200)) || fail "expand took $used MB"

# Requests of many parts that lie side by side: a chunk of each is in memory.
for k in {1..60}; do expand next --part "$k/60" -o "part.$k"; done
used=$(peak merge next part.* -o after)
echo "merge of 60 parts: $used MB"
((used < 100)) || fail "merge of 60 parts took $used MB"
