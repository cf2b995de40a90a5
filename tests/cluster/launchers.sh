# What needs no scheduler: the loop of examples/cluster/README.md, mpirun, GNU parallel, Snakemake.
source "$(dirname "$0")/../cli/lib.sh"
examples=$HAPGRID_SOURCE/examples/cluster
sed 's/^counts = .*/counts = [4, 6, 6]/; s/^spacing = .*/spacing = 0.15/' "$ball" >my.toml
seed my.toml | expand --complete -o reference
# check NAME COMMAND...: it makes the grid of one process, and says nothing.
check() {
  local name=$1
  shift
  "$@" >out 2>err || fail "$name: $(tail -n 20 err)"
  cmp my.grid reference || fail "$name makes another grid"
  [[ ! -s err || $name == snakemake ]] || fail "$name: $(cat err)"
  rm -r my.*[^l]
}

sed -n '/^```sh$/,/^```$/p' "$examples/README.md" | sed '/^```/d' >loop
same "lines of the loop" 7 "$(wc -l <loop)"
check loop bash -euo pipefail loop

if command -v mpirun >/dev/null; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  check mpirun "$examples/rounds.sh" my.toml 3 mpirun --oversubscribe -n 3
else
  missing mpirun
fi
if command -v parallel >/dev/null; then
  check parallel "$examples/rounds.sh" my.toml 3 "$examples/parallel.sh" 2/: 3
else
  missing parallel
fi
if command -v snakemake >/dev/null; then
  check snakemake snakemake -q -s "$examples/Snakefile" --cores 2 --config model=my.toml parts=3
else
  missing snakemake
fi

# A model that is a process: in its folder the rules for Snakemake need no more, and take up what changed in the script.
hapgrid init bead >/dev/null
sed -i 's/^counts = .*/counts = [3, 2, 2]/; s/^spacing = .*/spacing = 20/; s/^reach = 10 /reach = 40 /' bead/bead.toml
seed bead/bead.toml --allow-process | expand --complete --allow-process bead/bead.toml -o bead.reference
cat >serial <<'END'
#!/bin/bash
for rank in 0 1 2; do PMI_RANK=$rank PMI_SIZE=3 "$@"; done
END
chmod +x serial
(cd bead && ALLOW=yes "$examples/rounds.sh" bead.toml 3 ../serial) >out 2>err || fail "$(cat err)"
cmp bead.reference bead/bead.grid
rm -r bead/bead.grid bead/bead.rounds
if command -v snakemake >/dev/null; then
  (cd bead && snakemake -q --cores 2 >../out 2>&1) || fail "$(tail -n 20 out)"
  cmp bead.reference bead/bead.grid
  echo '# changed' >>bead/bead.py
  (cd bead && snakemake -n --cores 2) >out 2>&1
  grep -q 'Updated input files.*bead.py' out || fail "the script is no input: $(cat out)"
fi
rm -r bead bead.reference serial out err

# A round that failed is said again: what is there stays, and another definition begins anew.
cat >forgetful <<'END'
#!/bin/bash
for rank in 0 1 2; do
  [[ $rank == 1 && ! -e again ]] || PMI_RANK=$rank PMI_SIZE=3 "$@"
done
END
chmod +x forgetful
expect 123 '' '~merge: .*my.rounds/0.requests.2-of-3.*' -- "$examples/rounds.sh" my.toml 3 ./forgetful
nothing_left my.rounds lock seeds 0.grid 0.requests.1-of-3 0.requests.3-of-3
before=$(stat -c %i my.rounds/0.requests.1-of-3)
touch again
(
  flock 8
  expect 1 '' 'my.rounds: another driver is at work here' -- "$examples/rounds.sh" my.toml 3 ./forgetful
) 8>my.rounds/lock
sed -i '2a [[ -e seen ]] || { stat -c %i my.rounds/0.requests.1-of-3 >seen; }' forgetful
expect 0 '' '' -- "$examples/rounds.sh" my.toml 3 ./forgetful
cmp my.grid reference
same "the part that was there" "$before" "$(cat seen)"
sed -i 's/^counts = .*/counts = [4, 5, 6]/' my.toml
expect 0 '' '' -- "$examples/rounds.sh" my.toml 3 ./forgetful
seed my.toml | expand --complete | cmp - my.grid
