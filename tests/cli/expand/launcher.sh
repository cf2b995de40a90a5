# expand --part auto: the part that a launcher's environment gives a process, and what it does where
# the part's file is there already.
source "$(dirname "$0")/../lib.sh"
unset "${!SLURM_@}" "${!OMPI_@}" "${!PMI_@}"
seed "$ball" -o seeds
expand seeds | merge seeds - -o grid

# is K/N VARIABLE...: in this environment --part auto is this part.
is() {
  expand grid --part "$1" -o expected
  expect 0 '' '' -- env "${@:2}" expand grid --part auto -o got
  cmp got expected || fail "${*:2} is not part $1"
}
array() { echo SLURM_ARRAY_TASK_{ID="$1",MIN="$2",MAX="$3",STEP="$4"}; }

is 3/5 SLURM_PROCID=2 SLURM_NTASKS=5
is 1/2 SLURM_PROCID=0 SLURM_NTASKS=2
is 4/4 OMPI_COMM_WORLD_RANK=3 OMPI_COMM_WORLD_SIZE=4
is 2/3 PMI_RANK=1 PMI_SIZE=3
is 1/8 $(array 1 1 8 1)
is 8/8 $(array 7 0 7 1)
is 3/4 $(array 15 5 20 5)
# A task of its own is the whole round.
is 1/1 SLURM_PROCID=0 SLURM_NTASKS=1
# Elements of a job array that have one task each, with and without --ntasks.
is 2/8 $(array 2 1 8 1) SLURM_PROCID=0 SLURM_NTASKS=1
is 2/8 $(array 2 1 8 1) SLURM_PROCID=0
is 2/8 $(array 2 1 8 1) SLURM_PROCID=0 SLURM_NTASKS=1 PMI_RANK=0 PMI_SIZE=1
# Elements with several tasks, which share the round.
is 6/9 $(array 2 1 8 1) SLURM_PROCID=5 SLURM_NTASKS=9
# Under mpirun inside a Slurm job, Slurm's variables are those of mpirun's own daemon.
is 6/9 OMPI_COMM_WORLD_RANK=5 OMPI_COMM_WORLD_SIZE=9 SLURM_PROCID=0 SLURM_NTASKS=3

# {} in the output's name is the part. A part whose file is there is not computed again.
for rank in 0 1 2; do
  SLURM_PROCID=$rank SLURM_NTASKS=3 expand grid --part auto -o 'requests.{}'
done
nothing_left . seeds grid expected got requests.{1,2,3}-of-3
expand grid -o all
merge grid all -o expected
merge grid requests.* -o got
cmp got expected
before=$(stat -c %i.%y requests.2-of-3)
expect 0 '' '' -- expand grid --part 2/3 -o 'requests.{}'
same "the file" "$before" "$(stat -c %i.%y requests.2-of-3)"
# A name without {} can hold another part, so that file is written anew, as every output is.
cp requests.1-of-3 named
expand grid --part 2/3 -o named
cmp named requests.2-of-3

seed "$ball" --set grid.spacing=0.06 | tee other.seeds | expand -o other
merge other.seeds other -o other.grid
refusals "$here/launcher.tsv"
