# A grid verified in parts gives the report of one process, byte for byte; and what is no whole set
# of parts is refused.
source "$(dirname "$0")/../lib.sh"

seed "$ball" --set 'grid.counts=[24,12,12]' --set grid.spacing=0.08 \
  --set 'grid.origin=[-0.92,-0.44,-0.44]' | expand --complete -o grid
seed "$ball" --set 'grid.counts=[4,3,2]' --set 'grid.origin=[-0.9,0.0,0.0]' -o seeds
options=(--recompute 100 --walks 20 --accuracy 0.01 --scale 0.01)

# in_parts N GRID OPTION...: the parts' reports, merged in an order of their own, as both formats.
in_parts() {
  local n=$1 grid=$2 k
  shift 2
  rm -f part.*
  for k in $(seq "$n"); do
    expect 0 '' "~verify: part $k/$n: .*" -- verify "$grid" "$@" -j $((k % 3 + 1)) --part "$k/$n" -o "part.$k"
  done
  mapfile -t parts < <(seq -f 'part.%.0f' "$n" | shuf --random-source="$HAPGRID_BIN/verify")
  text=0 json=0
  verify --merge "${parts[@]}" >merged.text 2>merged.err || text=$?
  verify --merge "${parts[@]}" --format json >merged.json 2>/dev/null || json=$?
}

# As one process does: a fine grid, one that is not accurate enough, one that is not complete, a
# force of the wrong model.
mkdir changed
"${CXX:-c++}" -std=c++20 -shared -fPIC -I"$HAPGRID_SOURCE" -o changed/hung-ball.so \
  "$HAPGRID_SOURCE/tests/cli/verify/changed_ball.cpp"
check() {
  local code=$1 got=0
  shift
  verify "$@" >one.text 2>one.err || got=$?
  same "exit code of verify $*" "$code" "$got"
  verify "$@" --format json >one.json 2>one.err || true
  for n in 1 2 7; do
    in_parts "$n" "$@"
    same "exit codes of $n parts" "$code $code" "$text $json"
    cmp one.text merged.text
    cmp one.json merged.json
    cmp one.err merged.err
  done
}
check 3 grid "${options[@]}"
grep -q '^verify: broken: accurate' one.err || fail "$(cat one.err)"
check 0 grid --recompute 100 --walks 5
check 0 grid --recompute none
check 3 seeds
grep -q 'broken: complete (8 of 8), coverage (16 of 24)' one.err || fail "$(cat one.err)"
check 3 grid --model-path changed --recompute all --walks 3

# Fewer points than parts.
seed "$ball" --set 'grid.counts=[2,1,2]' | expand --complete -o tiny
check 0 tiny --walks 2

# What is no whole.
in_parts 3 grid "${options[@]}"
refuses 'verify: part 2 of 3 is missing' -- verify --merge part.1 part.3
refuses 'verify: part 3 of 3 is missing' -- verify --merge part.2 part.1
refuses 'verify: part.2: part 2 of 3, as part.2 is' -- verify --merge part.1 part.2 part.2 part.3
verify grid "${options[@]}" --part 2/4 2>/dev/null >other
refuses 'verify: other: it is part 2 of 4, not of 3, as part.1 is' -- verify --merge part.1 other part.3
verify grid "${options[@]}" --sample-seed 2 --part 2/3 2>/dev/null >other
refuses 'verify: other: it is made with another --sample-seed \(2, not 1\), as part.1 is' -- \
  verify --merge part.1 other part.3
verify tiny "${options[@]}" --part 2/3 2>/dev/null >other
refuses 'verify: other: it is of another grid \([0-9a-f]+, not [0-9a-f]+\), as part.1 is' -- \
  verify --merge part.1 other part.3
head -c 1000 part.2 >cut
refuses 'verify: cut: no whole report of verify --part' -- verify --merge part.1 cut part.3
sed 's/"part":2/"part":0/' part.2 >cut
refuses 'verify: cut: part 0 of 3 cannot be' -- verify --merge part.1 cut part.3
sed 's/"errors":\[[^,]*,/"errors":[null,/' part.2 >cut
refuses 'verify: cut: a place without its error' -- verify --merge part.1 cut part.3
for count in '"many"' -1 1e30 0.5 true; do
  sed "s/\"counted\":[0-9]*/\"counted\":$count/" part.2 >cut
  refuses 'verify: cut: a count that is none' -- verify --merge part.1 cut part.3
done
sed 's/"spacing":[^,]*/"spacing":"wide"/' part.2 >cut
refuses 'verify: cut: a number that is none' -- verify --merge part.1 cut part.3
sed 's/"hapgrid verify part":1/"hapgrid verify part":9/' part.2 >cut
refuses 'verify: cut: format 9 of verify --part, not 1' -- verify --merge part.1 cut part.3
verify grid --recompute none --format json 2>/dev/null >report
refuses 'verify: report: no report of verify --part' -- verify --merge report
refuses 'verify: none: No such file or directory' -- verify --merge none
verify --merge part.1 - part.3 <part.2 2>/dev/null >stdin.text || true
cmp stdin.text merged.text

see='\(see verify --help\)'
for part in 0/3 4/3 1 a/b; do expect 2 '' "~verify: --part: .*$see" -- verify grid --part $part; done
expect 2 '' "~verify: .* excludes .* $see" -- verify grid --part 1/3 --format json
expect 2 '' "~verify: .* excludes .* $see" -- verify --merge --walks 3 part.1
expect 2 '' "~verify: .* excludes .* $see" -- verify --merge --part 1/3 part.1
