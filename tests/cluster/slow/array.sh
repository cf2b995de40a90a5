# A round as a job array, whole, and with elements that are lost.
source "$(dirname "$0")/../../cli/lib.sh"
source "$here/../slurm.sh"
cluster_start 3 2
define 30
array() { hapgrid rounds my.toml -- sbatch -Q --wait --array=1-7%5 "$HAPGRID_SOURCE/examples/cluster/element.sh" >out 2>err; }
array || fail "$(cat err element.*)"
cmp my.grid reference
[[ ! -s err && -z $(squeue -h) ]] || fail "$(cat err; squeue)"

# Elements are cancelled: the round fails, and the same command goes on with what is missing.
rm -r my.rounds my.grid
array &
wait_for 60 "round 1" expanding 1
scancel --state=RUNNING --name=element.sh
! wait $! || fail "nothing was lost"
array || fail "$(cat err element.*)"
cmp my.grid reference
