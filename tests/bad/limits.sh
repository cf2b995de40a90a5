# Out of room, read-only, and pipes that are closed or slow. What a single write or call meets, and
# the limits of a process, are in faults.py.
source "$(dirname "$0")/../cli/lib.sh"

seed "$ball" --set 'grid.counts=[4,3,2]' -o grid
expand grid -o requests
seed "$ball" --set 'grid.counts=[100,100,2]' -o large
expand large -o large.requests
# More than a shard's writer keeps back: the disk gets full behind a write that went well.
seed "$ball" --set 'grid.counts=[200,200,2]' | expand --complete -o complete
(($(stat -c %s complete) > 150000)) || fail "one write is enough for it"
printf '%s\n' '-0.95 -0.45 -0.45' '-0.9 -0.44 -0.44' '-0.83 -0.38 -0.43' >path
expand --complete grid -o small
seed "$ball" --set 'grid.counts=[20,20,2]' | expand --complete -o medium
for i in {1..400}; do echo "-0.9$((i % 5)) -0.4$((i % 7)) -0.45"; done >long-path
play small --device path:long-path --log log.session --frames frames 2>/dev/null

# Each writer as it is told to write to d/out.
writers=(
  "seed $ball --set grid.counts=[100,100,2] -o d/out"
  "expand large -o d/out"
  "expand --complete large -o d/out"
  "merge large large.requests -o d/out"
  "merge complete -o d/out"
  "merge --small complete -o d/out"
  "stats medium --npy d/out"
  "stats log.session --npy d/out"
  "check-model $ball --steps 20 --format json -o d/out"
  "play small --device path:long-path --log d/out"
  "play small --device path:long-path --log d/out.session"
  "play small --device path:long-path --frames d/out"
  "play small --device path:path --report d/out"
  "view frames --png d/out"
  "view frames --xyz d/out"
)
# refused TOOL REGEX: it is run, and said in one line what happened; play tells what was felt before.
refused() {
  local code=0
  $1 >"$work/got/out" 2>"$work/got/err" || code=$?
  same "exit code of $1" 1 $code
  same "message of $1" "~${1%% *}: .*$2" \
    "$(grep -v '^play: [0-9]* ticks\?,\|^play: ticks\|^play: largest' "$work/got/err")"
}
files_of() { sha256sum -- * 2>/dev/null | grep -v ' d/' || true; }
before=$(files_of)

# A directory that is read-only, and one in the place of the file.
can_mount=
mkdir d
mount -t tmpfs -o size=4k none d 2>/dev/null && can_mount=1 && umount d
if [[ $can_mount ]]; then
  mount -t tmpfs -o ro none d
  trap 'umount "$work/in/d" 2>/dev/null || true; rm -rf "$work"' EXIT
  for tool in "${writers[@]}"; do
    refused "$tool" ': Read-only file system'
  done
  umount d
fi
mkdir d/out d/out.session
for tool in "${writers[@]}"; do
  refused "$tool" ': Is a directory'
done
nothing_left d out out.session
rmdir d/*

# A disk of so many pages, until everything finds room: first not even the file, then a part of it.
if [[ $can_mount ]]; then
  for tool in "${writers[@]}"; do
    fits=
    for pages in 0 1 5 33 257; do
      # A file that takes all the room there is: with size=0 there would be no limit.
      mount -t tmpfs -o size=$((4 * (pages + 1)))k none d
      head -c 4096 /dev/zero >d/other
      if $tool >"$work/got/out" 2>&1; then
        fits=$pages
        nothing_left d other "$(cd d && ls -d out*)"
      else
        rm -f d/out.session
        refused "$tool" ': No space left on device.*'
        # What was felt is kept as far as it went.
        [[ $tool == *session ]] && rm -f d/out.session
        nothing_left d other
      fi
      umount d
      [[ ! $fits ]] || break
    done
    [[ $fits && $fits != 0 ]] || fail "$tool: fits on $fits pages"
  done
  # A pipe is copied to TMPDIR first.
  mount -t tmpfs -o size=4k none d
  head -c 4096 /dev/zero >d/other
  for tool in expand merge stats verify; do
    TMPDIR=$PWD/d refuses "$tool: standard input, copied to $PWD/d: No space left on device" -- \
      $tool - < <(cat complete)
  done
  umount d
else
  echo "no small disks: mounting one is not allowed here"
fi

# A pipe whose reader is gone before anything is written.
for tool in "seed $ball" "expand large" "merge complete" "merge --small complete" "stats complete" \
  "stats complete --npy -" "verify complete --recompute none" "check-model $ball --steps 20" \
  "play small --device path:long-path --log -" "view frames" "view frames --xyz -" "view frames --png -"; do
  python3 -c '
import os, subprocess, sys
read, write = os.pipe()
os.close(read)
tool = subprocess.run(sys.argv[1:], stdout=write, stderr=subprocess.PIPE)
assert (tool.returncode, tool.stderr) == (-13, b""), tool' $tool || fail "closed pipe: $tool"
done
# A viewer that leaves ends no play.
expect 0 '' '~.*' -- bash -c 'play small --device path:long-path --frames - | true; exit ${PIPESTATUS[0]}'

# A pipe that gives a few bytes at a time.
cat >trickle <<'PYTHON'
import sys, time
data = open(sys.argv[1], "rb").read()
step = len(data) // 20 + 1
for at in range(0, len(data), step):
    sys.stdout.buffer.write(data[at : at + step])
    sys.stdout.buffer.flush()
    time.sleep(0.005)
PYTHON
slow() {
  local file=$1
  shift
  "$@" <"$file" >fast-result
  python3 trickle "$file" | "$@" | cmp - fast-result || fail "slowly: $*"
}
slow grid expand -
slow requests merge grid -
slow small merge --small -
slow small stats - --npy -
slow small verify - --recompute all 2>/dev/null
slow small play - --device path:path --log - 2>/dev/null
slow path play small --device path:- --log - 2>/dev/null
slow frames view - --xyz -
slow frames view - --png -
slow "$ball" seed - --set 'grid.counts=[4,3,2]'

same "inputs" "$before" "$(files_of | grep -v 'trickle\|fast-result')"
