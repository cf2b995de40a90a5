#!/bin/bash
# Filters that stay: the same shards, line by line, from models that are loaded once.
source "$(dirname "$0")/../lib.sh"

# serve FILTER OPTION...: lines to it go to descriptor 5, its answers come from 6; ask WORD... does both.
serve() {
  : >err
  mkfifo lines
  exec 6< <(exec "$@" --serve <lines 2>>err)
  exec 5>lines
  rm lines
}
ask() {
  local IFS=$'\t'
  echo "$*" >&5
  read -r -t 60 -u 6 code || fail "no answer: $(cat err)"
}
dismiss() {
  exec 5>&-
  ! read -r -t 60 -u 6 code || fail "an answer that nobody asked for: $code"
  exec 6<&-
}

# Each round as the filters make it that do not stay: requests in ranges, grid, frontier and counts.
seed "$ball" --set 'grid.counts=[6,4,4]' --set grid.spacing=0.15 -o seeds
cp seeds grid
cp seeds frontier
round=0
while (($(stats --get frontier grid) > 0)); do
  rm -rf plain served
  mkdir plain served
  expand frontier --ranges 2 --conversions 0:50 -o 'plain/a.{}'
  expand frontier --conversions 50:100000 -j 2 -o plain/b
  merge grid plain/* --frontier 'plain/frontier' --counts plain/counts -o plain/grid
  serve expand -j 2
  ask frontier --ranges 2 --conversions 0:50 -o 'served/a.{}'
  ask frontier -o served/b --conversions 50:100000
  dismiss
  serve merge
  ask served/* grid --frontier served/frontier --counts served/counts -o served/grid
  dismiss
  diff -r plain served
  [[ ! -s err ]] || fail "$(cat err)"
  mv plain/grid grid
  mv plain/frontier frontier
  round=$((round + 1))
done
((round >= 3)) || fail "only $round rounds"
rm -r plain served

# The requests can go from one filter to the other through a named pipe.
expand seeds -o requests
merge seeds requests -o expected
mkfifo pipe
serve expand
printf 'seeds\t-o\tpipe\n' >&5
printf 'seeds\tpipe\t-o\tpiped\n' | merge --serve >answer
same "answer of merge" 0 "$(cat answer)"
read -r -t 60 -u 6 code
same "answer of expand" 0 "$code"
dismiss
cmp piped expected
rm answer expected pipe piped requests

# A process says so when it starts.
define() {  # NAME WORD...
  cat <<TOML
model = {name = "$1", process = ["python3", "$HAPGRID_SOURCE/tests/unit/model/processes/puppet.py", "$2"]}
grid = {origin = [0, 0, 0], spacing = 1, counts = [$3, 3, 3]}
seeds = {points = [[0, 0, 0]]}
TOML
}
define puppet stderr 3 >puppet.toml
define puppet stderr 4 >longer.toml
for name in puppet longer; do seed $name.toml --allow-process -o $name.seeds 2>/dev/null; done
expand puppet.seeds --allow-process puppet.toml -o expected 2>/dev/null
started() { same "models that started" "$1" "$(grep -c '^hello from the model$' err)"; }
serve expand --allow-process puppet.toml
for k in 1 2 3; do
  ask puppet.seeds -o requests.$k --report report
  same "code" 0 "$code"
  cmp requests.$k expected
  started 1
done
# Of another grid, and after a failure, they are others.
ask longer.seeds -o longer
started 2
ask puppet.seeds -o requests.4
started 3
# What is wrong with a line is said, and the next one is done. -j and what is said of models is the server's.
for line in 'nobody' 'puppet.seeds -o' '- -o out' 'puppet.seeds' '' '--help' 'puppet.seeds -o out -j 2' \
  'puppet.seeds -o out --part 3/2' 'puppet.seeds -o missing/out' 'puppet.seeds -o out --serve'; do
  : >err
  ask $line
  [[ $code == [12] ]] || fail "exit code $code: $line"
  same "message of '$line'" '~expand: [^
]*' "$(grep -v '^hello' err)"
done
ask puppet.seeds -o requests.5
same "code" 0 "$code"
dismiss
cmp requests.5 expected
nothing_left . err expected frontier grid longer longer.seeds longer.toml puppet.seeds puppet.toml report requests.{1..5} seeds
# Each line has a report of its own: the seed is at a corner, which has 7 neighbours.
same "conversions" "7 7 7" "$(sed -E 's/.*"conversions":([0-9]+).*/\1/' report | paste -sd ' ')"

# The end of a line that was not written is not made up for.
printf 'seeds\t-o\tone\nseeds\t-o\ttwo' >lines
expect 1 0 'expand: standard input: the last line has no end, and was not run' -- expand --serve <lines
[[ -e one && ! -e two ]] || fail "it ran half a line"
expect 0 '' '' -- merge --serve </dev/null
expect 1 '' 'expand: cannot write to standard output' -- bash -c 'expand --serve <lines >/dev/full'
for option in seeds '-o out' '--part 1/2' '--complete' '--report r'; do
  expect 2 '' '~expand: --serve: [^ ]+ is for the lines that it reads \(see expand --help\)' -- expand --serve $option
done
