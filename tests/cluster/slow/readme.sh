#!/bin/bash
# The commands of examples/cluster/README.md, as printed.
source "$(dirname "$0")/../../cli/lib.sh"
source "$here/../slurm.sh"
command -v parallel >/dev/null || skip "no GNU parallel"
cluster_start 3 2

small=(grid.counts=[4,6,6] grid.spacing=0.15)
reference
sed 's/^counts = .*/counts = [4, 6, 6]/; s/^spacing = .*/spacing = 0.15/' "$ball" >my.toml
export HAPGRID=$HAPGRID_SOURCE HAPGRID_BIN
sed -n '/^```sh$/,/^```$/p' "$HAPGRID/examples/cluster/README.md" | grep -v '^```' >commands
[[ $(grep -c '^make\|^salloc\|^sbatch' commands) -ge 7 ]] || fail "no commands"
bash -euo pipefail commands >out 2>err || fail "$(tail -n 20 err out)"
for where in work claimed steps batch array xargs parallel; do cmp $where/my.grid reference; done
