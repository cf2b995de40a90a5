#!/bin/bash
# Makefile.example's grid, killed with SIGKILL at KILLS random moments and started again: the same
# bytes in the end, and nothing is lost or done twice but what was in flight when it was killed.
# SEED draws other moments.
source "$(dirname "$0")/../lib.sh"
kills=${KILLS:-12}
RANDOM=${SEED:-1}
small="grid.counts=[10,4,4] grid.spacing=0.15"

# Conversions that last, so that there is always something to kill.
sed 's/^plugin = .*/plugin = "sleeper"/; s/^radius/milliseconds = 1\nradius/' "$ball" >hung-ball.toml
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
seed hung-ball.toml --set "${small% *}" --set "${small#* }" | expand --complete -j 32 -o reference

# The filters write down when they begin and when what they make is there. That is known by -o,
# whatever Makefile.example calls it. Those that stay get their lines one by one.
mkdir bin
ln -s "$HAPGRID_BIN"/* bin
for tool in expand merge; do
  rm bin/$tool
  cat >bin/$tool <<TOOL
#!/bin/bash
note() {  # begin|end WORD...
  local what=\$1
  while [[ \$2 != -o ]]; do shift; done
  echo "\$what $tool \$3 \$EPOCHREALTIME" >>"$PWD/journal"
}
if [[ \${*: -1} == --serve ]]; then
  coproc { exec "$HAPGRID_BIN/$tool" "\$@"; }
  while IFS= read -r line; do
    IFS=\$'\t' read -ra words <<<"\$line"
    note begin "\${words[@]}"
    echo "\$line" >&\${COPROC[1]}
    read -r code <&\${COPROC[0]} || exit
    ((code)) || note end "\${words[@]}"
    echo \$code
  done
  exit
fi
note begin "\$@"
"$HAPGRID_BIN/$tool" "\$@" || exit
note end "\$@"
TOOL
  chmod +x bin/$tool
done
jobs=2
cat >tasks <<TASKS
#!/bin/bash
for task in {1..$jobs}; do "\$@" & done
wait
TASKS
chmod +x tasks
driver=(setsid make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL=hung-ball.toml
  HAPGRID_BIN=bin SET="$small" PARTS=5 PAUSE=0)

# start: a build in a session of its own; the ways to hand shards out take turns.
sessions=
trap '[[ ! $sessions ]] || pkill -KILL -s "$sessions" || true; rm -rf "$work"' EXIT
start() {
  # Those that have ended are nobody's to kill.
  [[ ! $sessions ]] || sessions=$(ps -o sid= -s "$sessions" | tr -d ' ' | sort -u | paste -sd ,)
  case $((RANDOM % 4)) in
    0) how=(-j "$jobs") ;;
    1) how=(-j "$jobs" RUN=env) ;;
    2) how=(MODE=claim RUN=./tasks) ;;
    3) how=(MODE=list RUN="xargs -P $jobs -n 1") ;;
  esac
  "${driver[@]}" "${how[@]}" >make.out 2>make.err &
  build=$!
  sessions+=${sessions:+,}$build
}
running() { [[ $sessions && $(pgrep -s "$sessions") ]]; }
alive() { [[ $(ps -o stat= -p $build) == [!Z]* ]]; }
# one_of NAME...: `victim` is a process of the builds with such a name, or any, or sometimes none.
one_of() {
  local pids
  mapfile -t pids < <(ps -o pid=,comm= -s "$sessions" |
    awk -v names=" $* " 'names == "  " || index(names, " " $2 " ") { print $1 }')
  victim=${pids[RANDOM % (${#pids[@]} + 1)]-}
  [[ $victim ]]
}
# in_flight: the most shards that all builds together are at work on.
in_flight() { echo $((jobs * $(ps -o sid= -s "$sessions" | sort -u | wc -l))); }
# The ways to kill take turns; what may be lost by it is added to `lost`.
lost=0
kill_something() {
  local victim
  case $((kill % 5)) in
    0) lost=$((lost + $(in_flight))) what="everything"
      pkill -KILL -s "$sessions" ;;
    1) lost=$((lost + jobs)) what="a process group"
      kill -KILL -- -$build ;;
    2) what="all makes"
      pkill -KILL -s "$sessions" -x make ;;
    3) lost=$((lost + 1)) what="a filter"
      one_of expand merge seed stats && kill -KILL "$victim" ;;
    4) lost=$((lost + 1)) what="a process"
      one_of && kill -KILL "$victim" ;;
  esac 2>/dev/null
}

# A grid that is complete: the journal and the reports against what one process needed.
check_grid() {
  while running; do sleep 0.05; done  # what outlived its make
  sessions=
  cmp work/hung-ball.grid reference
  grids=$((grids + 1))
  python3 - $lost "$(stats reference --get conversions)" <<'PYTHON' || fail "see above"
import json, sys
from collections import defaultdict

may_be_lost, reference = int(sys.argv[1]), int(sys.argv[2])
begins, ends, kills = defaultdict(list), defaultdict(list), []
for line in open("journal"):
    what, tool, product, time = line.split()
    if what == "kill":
        kills.append(float(time))
    else:
        (begins if what == "begin" else ends)[tool, product].append(float(time))
# To look whether a product is there and to begin it are two steps, and what outlived its make can
# finish it in between: that is in flight, too. Before a merge there is more to look at. And so is what
# was killed between its end and the note of it.
look_s = {"expand": 1, "merge": 5}
note_s = 0.5
again = [p for p in begins for b in begins[p] for e in ends[p]
         if e + look_s[p[0]] < b and not any(e < k < e + note_s for k in kills)]
assert not again, f"made again: {again}"
lost = sum(len(begins[p]) - len(ends[p]) for p in begins)
assert lost <= may_be_lost, f"{lost} were lost, {may_be_lost} may have been in flight"

# A filter that outlives what started it reports, and does not end here.
expands = [p for p in begins if p[0] == "expand"]
again = sum(len(begins[p]) - 1 for p in expands)
unsaid = sum(not ends[p] for p in expands)  # killed when it had made its product
lines = [json.loads(line) for line in open("work/hung-ball.report")]
counts = [line["conversions"] for line in lines if line["tool"] == "expand"]
total, largest = sum(counts), max(counts)
assert reference - unsaid * largest <= total <= reference + again * largest, (
    total, reference, again, unsaid, largest)
print(f"a grid: {len(expands)} shards, {again} begun again; {lost} filters lost in flight, of "
      f"{may_be_lost} at most; {total} conversions reported, {reference} needed")
PYTHON
  # What is left is what a build leaves that nobody kills.
  "${driver[@]}" >make.out
  same "files" "$calm" "$(files)"
  rm -rf work journal
  lost=0
}
files() { (cd work && find . | sed 's,/[0-9a-f]\{12\}\(/\|$\),/KEY\1,' | sort); }

grids=0 calm=
"${driver[@]}" -j 32 >make.out
calm=$(files)
check_grid

start
for ((kill = 0; kill < kills;)); do
  sleep "$(printf '0.%03d' $((RANDOM % 400)))"
  if running && kill_something; then
    echo "kill $((++kill)): $what"
    echo "kill $kill - $EPOCHREALTIME" >>journal
    sleep 0.02
  fi
  alive && continue
  if wait $build; then check_grid; fi
  start
done
for ((tries = 0; tries < 50; ++tries)); do
  if wait $build; then break; fi
  sleep 0.1
  start
done
check_grid
echo "$kills kills, $grids grids"
