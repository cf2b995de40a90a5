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
  refuses "$name: empty: empty, not a shard" -- $tool empty
  refuses "$name: standard input: empty, not a shard" -- $tool - </dev/null
  refuses "$name: text: byte 0: not a shard: no zstd frame" -- $tool text
  refuses "$name: standard input: byte 0: not a shard: no zstd frame" -- $tool - <text
  refuses "$name: directory: Is a directory" -- $tool directory
  refuses "$name: standard input: Is a directory" -- $tool - <directory
  refuses "$name: missing: No such file or directory" -- $tool missing
  [[ ${HAPGRID_WRAPPER-} ]] ||  # valgrind opens /dev/null for it
    refuses "$name: standard input: Bad file descriptor" -- bash -c "exec $tool - <&-"
  refuses "$name: text/x: Not a directory" -- $tool text/x
  expect 2 '' "~$name: .* \(see $name --help\)" -- $tool - - <grid
  # A name with a line break stays in one line.
  refuses "$name: a b: No such file or directory" -- $tool $'a\nb'
done
# A stream of another kind, which would not end, is refused by its first bytes.
for tool in "${readers[@]}"; do
  name=${tool%% *}
  refuses "$name: /dev/zero: byte 0: not a shard: no zstd frame" -- timeout 20 $tool /dev/zero
  refuses "$name: standard input: byte 0: not a shard: no zstd frame" -- timeout 20 $tool - < <(yes)
done
# Compressed once more, from a file and through a pipe.
for by in gzip bzip2 xz zstd; do
  $by -c grid >grid.packed
  for tool in expand 'merge' 'verify --recompute none'; do
    words="byte 0: this is $by, not a shard: unpack it first\. Shards are compressed already"
    refuses "${tool%% *}: grid\.packed: $words" -- $tool grid.packed
    refuses "${tool%% *}: standard input: $words" -- bash -c "cat grid.packed | $tool"
  done
done
echo '0 0 0' >path
expand --complete grid -o whole
refuses 'play: /dev/zero: byte 0: not a shard: no zstd frame' -- timeout 20 play /dev/zero --device path:path
refuses 'play: /dev/zero: .*' -- timeout 20 play whole --device replay:/dev/zero
refuses 'stats: /dev/zero: .*' -- timeout 20 stats /dev/zero
refuses 'seed: missing: No such file or directory' -- seed missing
refuses 'seed: directory: Is a directory' -- seed directory
refuses 'seed: standard input: line 1: .*' -- seed - <text
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
for tool in seed expand merge stats verify play view check-model; do
  refuses "$tool: cannot write to standard output" -- bash -c "exec $tool --help >/dev/full"
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
