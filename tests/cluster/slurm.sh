# shellcheck shell=bash
# A Slurm of one's own for tests: munged, slurmctld and several slurmd on this machine, as root, with
# keys, ports and files that touch nothing of an installed one. Sourced after ../cli/lib.sh:
#
#   cluster_start NODES CPUS    starts it, sets SLURM_CONF; skips the test where it cannot
#   node_kill N                 SIGKILLs the N-th slurmd (from 1) and all that runs under it
#   node_start N                starts it again
#   cluster_stop                everything off
#   in_allocation, define, expanding    see below
#
# It ends with the script, however that ends.

# The first of NODES + 1 ports, of 16 at most; two of these tests at a time have different ones.
cluster_ports=$((20000 + ($$ % 700) * 16))

cluster_configure() {
  local nodes=$1 cpus=$2 n
  cluster=$work/cluster
  mkdir -p "$cluster/munge" "$cluster/state"
  chmod 755 "$work" "$cluster" "$cluster/munge"
  (umask 077 && dd if=/dev/urandom of="$cluster/munge/key" bs=1024 count=1 status=none)
  chmod 0400 "$cluster/munge/key"
  cat >"$cluster/slurm.conf" <<END
ClusterName=hapgrid
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$cluster_ports
SlurmUser=root
SlurmdUser=root
SlurmdParameters=config_overrides
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$cluster/munge/socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1
ReturnToService=2
SlurmdTimeout=5
InactiveLimit=0
KillWait=2
MaxArraySize=100001
MaxJobCount=100000
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool.%n
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/%n.pid
SlurmctldLogFile=$cluster/slurmctld.log
SlurmdLogFile=$cluster/%n.log
NodeName=DEFAULT CPUs=$cpus RealMemory=1000 State=UNKNOWN
$(for n in $(seq "$nodes"); do
    echo "NodeName=n$n NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((cluster_ports + n))"
  done)
PartitionName=test Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
  echo CgroupPlugin=cgroup/v1 >"$cluster/cgroup.conf"  # never touched; keeps slurmd from probing
  export SLURM_CONF=$cluster/slurm.conf
}

cluster_start() {
  [[ $(id -u) == 0 ]] || skip "a Slurm of one's own is started as root"
  local program n
  for program in munged slurmctld slurmd srun sbatch; do
    needs $program "slurmctld slurmd slurm-client munge"
  done
  cluster_nodes=$1
  cluster_configure "$1" "$2"
  trap 'cluster_stop; pid=$(cat "$cluster/munge/pid" 2>/dev/null) && kill "$pid"; rm -rf "$work"' EXIT
  trap 'exit 1' INT TERM HUP
  munged --force --key-file="$cluster/munge/key" --socket="$cluster/munge/socket" \
    --pid-file="$cluster/munge/pid" --log-file="$cluster/munge/log" --seed-file="$cluster/munge/seed" \
    >"$cluster/munge/out" 2>&1 || fail "munged: $(cat "$cluster/munge/out")"
  slurmctld -f "$SLURM_CONF"
  for n in $(seq "$cluster_nodes"); do node_start "$n"; done
  wait_for 60 "cluster that answers" cluster_answers
}

# Exactly this word: a * behind it is a node that does not answer, and `sinfo -t idle` counts unknown
# ones, too.
cluster_answers() { [[ $(sinfo -h -N -o %T 2>/dev/null | grep -cx idle) == "$cluster_nodes" ]]; }

node_start() { slurmd -f "$SLURM_CONF" -N "n$1"; }

# node_processes N: its slurmd and step daemons have its log open, its tasks carry its name; and all of
# them are of this cluster.
node_processes() {
  local pid
  for pid in $(pgrep -x 'slurmd|slurmstepd'); do
    [[ $(readlink "/proc/$pid/fd/"* 2>/dev/null) == *"$cluster/n$1.log"* ]] && echo "$pid"
  done
  for pid in $(grep -lzx "SLURMD_NODENAME=n$1" /proc/[0-9]*/environ 2>/dev/null | cut -d / -f 3); do
    grep -qzxF "SLURM_CONF=$SLURM_CONF" "/proc/$pid/environ" 2>/dev/null && echo "$pid"
  done
  true
}

# As when a machine loses power.
node_kill() {
  local pid
  for pid in $(node_processes "$1"); do kill -KILL "$pid" 2>/dev/null || true; done
  rm -f "$cluster/n$1.pid"
}

cluster_stop() {
  local pid n
  if pid=$(cat "$cluster/slurmctld.pid" 2>/dev/null) && kill "$pid" 2>/dev/null; then
    wait_for 20 "slurmctld's end" eval '[[ $(ps -o stat= -p '"$pid"') != [!Z]* ]]'
  fi
  for n in $(seq "$cluster_nodes"); do node_kill "$n"; done
}

# in_allocation TASKS COMMAND...: in an allocation of so many tasks.
in_allocation() { salloc -Q -n "$1" "${@:2}" >out 2>err || fail "$(tail -n 20 err out)"; }

# define MILLISECONDS: my.toml, a toy whose conversions take so long, and `reference`, what one process makes of it.
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
define() {
  cat >my.toml <<TOML
model = {plugin = "toy", parameters = {amplitude = 0, milliseconds = $1}}
grid = {origin = [0, 0, 0], spacing = 1, counts = [4, 6, 6]}
TOML
  seed my.toml | expand --complete -j 32 -o reference
}

# expanding N [NODE]: a part of the N-th generation is being expanded (on that node).
expanding() {
  local pid
  for pid in $(pgrep -x expand); do
    [[ $(readlink "/proc/$pid/fd/"*) == *"$PWD/my.rounds/0000$1.grid"* ]] || continue
    # Not grep -q, which would end before node_processes does, and fail it.
    [[ ! ${2-} ]] || node_processes "$2" | grep -x "$pid" >/dev/null || continue
    return 0
  done
  return 1
}
