#!/bin/bash
# A launcher for hapgrid rounds: GNU parallel starts the parts over ssh, without any scheduler.
#
#   parallel.sh HOSTS PARTS COMMAND...      HOSTS as --sshlogin has them: 16/host1,16/host2; ':' is this machine
#
# All hosts see the working directory and the filters under the same path.
set -euo pipefail
hosts=$1 parts=$2
command=(env "PATH=$PATH" "PMI_SIZE=$parts" PMI_RANK=@rank@ "${@:3}")
seq 0 $((parts - 1)) |
  parallel --will-cite --sshlogin "$hosts" -I @rank@ "cd $(printf %q "$PWD") && $(printf '%q ' "${command[@]}")"
