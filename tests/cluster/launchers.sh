# What needs no scheduler: the loop of examples/cluster/README.md, mpirun, GNU parallel, Snakemake.
source "$(dirname "$0")/../cli/lib.sh"
examples=$HAPGRID_SOURCE/examples/cluster
sed 's/^counts = .*/counts = [4, 6, 6]/; s/^spacing = .*/spacing = 0.15/' "$ball" >my.toml
seed my.toml | expand --complete -o reference

# The loop as it stands, in the shells that readers have. A part fails in the middle, and a merge: what is there stays, and
# the same lines go on.
sed -n '/^```sh$/,/^```$/p' "$examples/README.md" | sed '/^```/d' >loop
same "lines of the loop" 8 "$(wc -l <loop)"
mkdir bin
for tool in expand merge; do
  cat >bin/$tool <<END
#!/bin/bash
[[ ! -e $PWD/fails || \$* != *\$(cat "$PWD/fails")* ]] || { echo $tool fails >&2; exit 1; }
exec "$HAPGRID_BIN/$tool" "\$@"
END
  chmod +x bin/$tool
done
kept() { stat -c '%n %i %s' -- * | sort; }
for shell in sh bash; do
  mkdir $shell
  cd $shell
  cp ../my.toml .
  for fails in '2.grid*5/8' '-o 3.grid'; do
    echo "$fails" >../fails
    PATH=$work/in/bin:$PATH $shell ../loop >../out 2>../err || true
    grep -qE '^(expand|merge) fails' ../err || fail "nothing has failed: $(cat ../err)"
    before=$(kept)
    PATH=$work/in/bin:$PATH $shell ../loop >../out 2>../err || true
    same "files of a round that fails" "$before" "$(kept)"
  done
  rm ../fails
  $shell ../loop >../out 2>../err || fail "$(cat ../err)"
  cmp "$(ls -v ./*.grid | tail -n 1)" ../reference
  cd ..
done

# check NAME COMMAND...: it makes the grid of one process, and says no more than its rounds.
check() {
  local name=$1
  shift
  "$@" >out 2>err || fail "$name: $(tail -n 20 err)"
  cmp my.grid reference || fail "$name makes another grid"
  [[ ! -s err || $name == snakemake ]] || fail "$name: $(cat err)"
  rm -r my.grid my.rounds
}
if command -v mpirun >/dev/null; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  check mpirun hapgrid rounds my.toml -- mpirun --oversubscribe -n 3
else
  missing mpirun
fi
if command -v parallel >/dev/null; then
  check parallel hapgrid rounds my.toml -- "$examples/parallel.sh" 2/: 3
else
  missing parallel
fi
if ! command -v snakemake >/dev/null; then
  missing snakemake
  exit 0
fi
check snakemake snakemake -q -s "$examples/Snakefile" --cores 2 --config model=my.toml parts=3
check snakemake snakemake -q -s "$examples/Snakefile" --cores 2 --config model=my.toml launcher='mpirun --oversubscribe -n 2'

# In the folder of a model that is a process the rule needs no more, and takes up what changed in the script.
hapgrid init bead >/dev/null
sed -i 's/^counts = .*/counts = [3, 2, 2]/; s/^spacing = .*/spacing = 20/; s/^reach = 10 /reach = 40 /' bead/bead.toml
seed bead/bead.toml --allow-process | expand --complete --allow-process bead/bead.toml -o reference
cd bead
for _ in 1 2; do
  snakemake -q --cores 2 >../out 2>&1 || fail "$(tail -n 20 ../out)"
  cmp bead.grid ../reference
  grep -q '^bead.grid: round 1 ' ../out || fail "a script that has changed makes no new grid: $(cat ../out)"
  echo '# changed' >>bead.py
done
