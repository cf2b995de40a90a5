# hapgrid rounds: the same bytes as expand --complete, whatever the names; parts that fail or get lost, seeds that fail,
# signals, a changed definition, two drivers, no locks, 10,000 parts. kills.sh has SIGKILL.
source "$(dirname "$0")/../lib.sh"
sed 's/^counts = .*/counts = [4, 6, 6]/; s/^spacing = .*/spacing = 0.15/' "$ball" >my.toml
seed my.toml | expand --complete -o reference
conversions=$(stats reference --get conversions)
# kept DIRECTORY: the names and inodes of what is there.
kept() { (cd "$1" && stat -c '%n %i %s' -- * | sort); }

# A line a round, but for those within two seconds, and one at the end. A part's cost is that of its work.
last=$(stats --get generation reference)
expect 0 "~my.grid: round 1 is for 8 records"$'\n'"(.*"$'\n'")*my.grid: complete after $last rounds" '' -- hapgrid rounds my.toml --parts 3
cmp my.grid reference
nothing_left my.rounds cost finished lock
same "conversions" "$conversions" "$(stats my.grid --cost my.rounds/cost --get costs.conversions)"
# Repeated, it does nothing; when the grid is removed it is made again.
before=$(kept .)
expect 0 'my.grid: is complete' '' -- hapgrid rounds my.toml --parts 5
same "what is there" "$before" "$(kept .)"
rm my.grid
hapgrid rounds my.toml >out
cmp my.grid reference

# A seed that fails touches nothing: neither a grid, nor rounds that were begun, nor a folder that it would have made.
cp my.toml good.toml
expect 1 '~.*' '~rounds: my.grid: round 2 failed \(parts: none\): .*' -- \
  hapgrid rounds my.toml --set grid.counts=[4,5,6] -- bash -c 'case $2 in */00001.grid) exit 1 ;; esac; PMI_RANK=0 PMI_SIZE=1 exec "$@"' part
before=$(kept my.rounds)
sed -i 's/^counts/cuonts/' my.toml
refuses 'seed: my\.toml: .*cuonts.*' -- hapgrid rounds my.toml
refuses 'seed: my\.toml: .*cuonts.*' -- hapgrid rounds my.toml -o new.grid
same "rounds after a seed that failed" "$before" "$(kept my.rounds)"
[[ ! -e new.rounds ]] || fail "there is a folder for nothing"
# The old grid stays while the new one is searched, and is still known to be complete.
mv good.toml my.toml
cmp my.grid reference
expect 0 'my.grid: is complete' '' -- hapgrid rounds my.toml
expect 0 '~my.grid: goes on after round 1.*' '' -- hapgrid rounds my.toml --set grid.counts=[4,5,6]
seed my.toml --set grid.counts=[4,5,6] | expand --complete | cmp - my.grid

# Any name, in any folder, beside the model and its data; of files with other names than its own nothing is touched.
folder="-a b'c\"d\$e ü.v2{}*" name="-m ü'\$(x).v2"
mkdir -- "$folder" "./$folder/$name.rounds"
cp my.toml "./$folder/$name.toml"
touch "./$folder"/{my.py,data.bin,00001.grid.txt} "./$folder/$name.rounds"/{notes.txt,a.grid,7.requests}
for way in rounds make; do
  for there in "$folder" .; do
    cd "./$([[ $there != . ]] || echo "$folder")"
    if [[ $way == rounds ]]; then
      hapgrid rounds "./$there/$name.toml" -o "$there/$name.grid" --parts 2
    else
      make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL="$([[ $there == . ]] || echo "$there/")$name.toml" WORK="$there" PARTS=2
    fi >"$work/in/out" 2>&1 || fail "$way in $there: $(cat "$work/in/out")"
    cd "$work/in"
    cmp "./$folder/$name.grid" reference
    nothing_left "./$folder" my.py data.bin 00001.grid.txt "$name".{toml,grid,rounds}
    nothing_left "./$folder/$name.rounds" notes.txt a.grid 7.requests cost finished lock
    rm "./$folder/$name.grid"
  done
done
cmp "./$folder/$name.toml" my.toml

# A launcher that loses every fifth part, saying that all is well (0) or not (1): the same command makes what is missing,
# and no part twice.
cat >forgetful <<'END_OF_IT'
#!/bin/bash
for PMI_RANK in 0 1 2 3; do
  export PMI_RANK PMI_SIZE=4
  echo >>count
  (($(wc -l <count) % 5 == 0)) || "$@"
done
exit "$LOSS"
END_OF_IT
chmod +x forgetful
for LOSS in 0 1; do
  export LOSS
  rm -rf my.rounds my.grid count
  said=0
  until hapgrid rounds my.toml -- ./forgetful >out 2>err; do
    same "line" '~rounds: my\.grid: round [0-9] failed \(parts: [1-3] of 4\): the same command makes what is missing' "$(cat err)"
    ((++said < 19)) || fail "it does not go on"
  done
  ((said > 1)) || fail "only $said were lost"
  cmp my.grid reference
  same "conversions" "$conversions" "$(stats reference --cost my.rounds/cost --get costs.conversions)"
done

# Parts of rounds with other numbers are no part of this one; a signal ends the parts, too.
rm -r my.rounds my.grid
cat >slow <<'END_OF_IT'
#!/bin/bash
PMI_RANK=0 PMI_SIZE=2 "$@"
sleep 1234 &
echo $! >sleeping
wait
END_OF_IT
chmod +x slow
hapgrid rounds my.toml -- ./slow >out 2>err &
wait_for 60 "part" test -s sleeping
code=0
kill $!
wait $! || code=$?
same "exit code" 143 $code
wait_for 20 "end of the part" eval '[[ $(ps -o stat= -p "$(cat sleeping)") != [!Z]* ]]'
nothing_left my.rounds lock seeds 00000.grid 00000.requests.1-of-2 cost
expect 0 '~.*' '' -- hapgrid rounds my.toml --parts 3
cmp my.grid reference

# As many parts at a time as there are processors, whatever linear algebra is told; a signal ends all of them.
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
cat >toy.toml <<TOML
model = {plugin = "toy", parameters = {amplitude = 0, milliseconds = 100}}
grid = {origin = [0, 0, 0], spacing = 1, counts = [9, 9, 9]}
TOML
at_work() { pgrep -fc "^[^ ]*/expand $1/toy.rounds/.*--part" || true; }  # not xargs, whose words these are, too
OMP_NUM_THREADS=1 hapgrid rounds toy.toml -o "$PWD/toy.grid" >out 2>err &
driver=$!
wait_for 60 "part for each processor" eval '(($(at_work "$PWD") == $(nproc)))'
kill $driver
wait $driver || true
wait_for 20 "end of the parts" eval '(($(at_work "$PWD") == 0))'

# Two drivers in one folder: the second ends with a line that says why, and touches nothing.
before=$(kept my.rounds)
(
  flock 8
  refuses 'rounds: my\.rounds: another driver is at work here' -- hapgrid rounds my.toml --set grid.counts=[4,5,6]
) 8>>my.rounds/lock
same "rounds of another driver" "$before" "$(kept my.rounds)"
# A file system without locks.
if command -v strace >/dev/null; then
  for error in ENOLCK ENOSYS; do
    rm -r my.rounds my.grid
    strace -f -qq -o /dev/null -e inject=flock:error=$error hapgrid rounds my.toml --parts 2 >out 2>err || fail "$(cat err)"
    same "what is said" 'rounds: my.rounds: there are no locks here: see that no second driver is at work' "$(grep -v 'my.rounds/cost cannot be locked' err)"
    cmp my.grid reference
  done
else
  missing strace
fi

# A file that the model consists of.
touch -d tomorrow model.so
expect 0 '~my.grid: round 1 .*' '' -- hapgrid rounds my.toml --depends model.so
touch -d yesterday model.so
expect 0 'my.grid: is complete' '' -- hapgrid rounds my.toml --depends=model.so

# 10,000 parts, in a folder whose name makes an argument list of them too long; no more are started than conversions.
deep=$(printf 'd%.0s' {1..240})
mkdir "$deep"
small=(my.toml --set grid.counts=[2,2,2] --set grid.spacing=0.05)
seed "${small[@]}" | expand --complete -o reference
cat >many <<'END_OF_IT'
#!/usr/bin/python3
import os, subprocess, sys
command, pattern = sys.argv[1:-1], sys.argv[sys.argv.index("-o") + 1]
for part in ("1/2", "2/2", "10000/10000"):
    subprocess.run([*command, part], check=True)
file = lambda k, of: pattern.replace("{}", f"{k}-of-{of}")
for k in (1, 2):
    os.rename(file(k, 2), file(k, 10000))
for k in range(3, 10000):
    os.link(file(10000, 10000), file(k, 10000))  # there is nothing to do in these, either
END_OF_IT
chmod +x many
expect 0 '~.*' '' -- hapgrid rounds "${small[@]}" -o "$deep/a.grid" -- ./many
cmp "$deep/a.grid" reference
nothing_left "$deep/a.rounds" cost finished lock
expect 0 '~.*' '' -- hapgrid rounds "${small[@]}" -o b.grid --parts 10000
cmp b.grid reference

# Command lines that are wrong, or cannot be done.
help='\(see [a-z]+ --help\)'
while IFS='|' read -r code said arguments; do
  expect "$code" '~.*' "~$said" -- hapgrid rounds $arguments
done <<TABLE
2|rounds: definition is required $help|
2|rounds: definition: must be a file $help|-
2|rounds: The following argument was not expected: other $help|my.toml other
2|rounds: The following argument was not expected: --nonsense $help|my.toml --nonsense
2|rounds: -o: 1 required value missing $help|my.toml -o
2|rounds: --output: the grid would replace the definition $help|my.toml -o ./my.toml
2|rounds: --parts: '0' is not a whole number from 1 to 999999999 $help|my.toml --parts=0
2|rounds: --parts: a launcher has its own number of parts $help|my.toml --parts 3 -- ./many
2|rounds: --: no launcher is behind it $help|my.toml --
2|rounds: --set model.timeout: the parts read it from MODEL.toml: change it there $help|my.toml --set model.timeout=3
2|expand: --threads: .*2000.* $help|my.toml -j2000
1|rounds: nonsense: there is no such command|my.toml -- nonsense
1|rounds: nowhere: there is no such file|my.toml --depends nowhere
1|rounds: .: is a folder|my.toml -o .
1|rounds: nowhere/my.rounds: a folder to write into cannot be made|my.toml -o nowhere/my.grid
1|merge: level limit: .*|my.toml --set search.max_levels=1 --set grid.counts=[12,6,6] -o level.grid --parts 1
TABLE
