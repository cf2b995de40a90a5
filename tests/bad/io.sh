# Inputs that are no shards, and outputs that cannot be written.
source "$(dirname "$0")/../cli/lib.sh"

seed "$ball" --set 'grid.counts=[4,3,2]' -o grid
expand grid -o requests
: >empty
echo "not a shard" >text
mkdir directory
readers=("expand" "expand --complete" "merge" "merge grid" "merge requests" "stats" "verify")

for tool in "${readers[@]}"; do
  name=${tool%% *}
  refusals "$here/readers.tsv"
  [[ ${HAPGRID_WRAPPER-} ]] ||  # valgrind opens /dev/null for it
    refuses "$name: standard input: Bad file descriptor" -- bash -c "exec $tool - <&-"
done
echo '0 0 0' >path
expand --complete grid -o whole
refusals "$here/io.tsv"
if [[ $(id -u) != 0 ]]; then
  chmod a-r text
  refuses 'expand: text: Permission denied' -- expand text
fi

# A disk that is full, as -o and as standard output; each of them is seen.
writers=("seed $ball" "expand grid" "expand --complete grid" "merge grid requests")
for tool in "${writers[@]}"; do
  name=${tool%% *}
  refuses "$name: /dev/full: No space left on device" -- $tool -o /dev/full
  refuses "$name: standard output: No space left on device" -- bash -c "exec $tool >/dev/full"
  [[ ${HAPGRID_WRAPPER-} ]] ||
    refuses "$name: standard output: Bad file descriptor" -- bash -c "exec $tool >&-"
done
for tool in "stats grid" "stats --npy - grid" "verify grid --recompute none"; do
  code=0
  bash -c "exec $tool >/dev/full" 2>err || code=$?
  same "exit code of $tool > /dev/full" 1 "$code"
  grep -q "No space left on device\|cannot write" err || fail "$(cat err)"
done
# A file that may not grow: what was written so far goes, whether the tool hears of it or is killed.
seed "$ball" --set 'grid.counts=[300,300,2]' -o large
expand large --complete -o complete
(($(stat -c %s complete) > 16384)) || fail "too small to be cut"
for tool in "expand --complete large" "merge complete"; do
  # A search of more than a second has a checkpoint, which cannot be written either.
  expect 1 '' $'~(expand: cannot keep what is found: out\\.partial: File too large\n)?'"${tool%% *}: out: File too large" -- \
    bash -c "trap '' XFSZ; ulimit -f 8; exec $tool -o out"
  [[ ! -e out ]] || fail "half a file"
  (ulimit -f 8; $tool -o out) 2>err && fail "no SIGXFSZ"
  [[ ! -e out ]] || fail "half a file"
done

# With standard streams closed, no message ends up in a file that took their place.
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
seed - -o slow <<END
grid = {origin = [0, 0, 0], spacing = 1, counts = [2, 1, 1]}
model = {plugin = "toy", parameters = {milliseconds = 300}}
END
expand slow -o fine
bash -c 'exec expand slow -o out <&- >&- 2>&-'
cmp out fine || fail "closed standard streams"

# A closed pipe: SIGPIPE, as any filter, and no message.
for tool in "expand --complete large" "merge complete" "stats --npy - complete"; do
  python3 -c '
import subprocess, sys
tool = subprocess.Popen(sys.argv[1:], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
tool.stdout.read(10)
tool.stdout.close()
err = tool.stderr.read()
code = tool.wait()
assert (code, err) == (-13, b""), (code, err)' $tool || fail "closed pipe: $tool"
done

# Never binary to a terminal; progress and all is taken away again.
for tool in "${writers[@]}"; do
  name=${tool%% *}
  code=0
  script -qec "$tool 2>err" typescript </dev/null >screen || code=$?
  same "exit code of $tool on a terminal" 1 "$code"
  same "message of $tool on a terminal" \
    "$name: standard output is a terminal: redirect it, or name a file with -o" "$(cat err)"
  [[ ! -s screen ]] || fail "$tool writes to a terminal: $(head -c 100 screen)"
done
