#!/bin/bash
# Computes MODEL.grid from MODEL.toml in rounds of PARTS parts, which a launcher starts:
#
#   rounds.sh MODEL.toml PARTS LAUNCHER...
#
# With ALLOW=yes in the environment, the command of a model that is a process may be started.
# The launcher runs the command behind it PARTS times, and expand finds its part in the environment.
# Files appear whole or not at all, and a part whose file is there is not computed again: when a round
# fails, run the same command again.
set -euo pipefail
model=$1 parts=$2 launcher=("${@:3}")
name=$(basename "$model" .toml)
mkdir -p "$name.rounds"
exec 9>"$name.rounds/lock"
flock -n 9 || { echo "$name.rounds: another driver is at work here" >&2; exit 1; }

allow=(${ALLOW:+--allow-process})
if ! seed "$model" "${allow[@]}" | cmp -s - "$name.rounds/seeds"; then  # this is another grid: begin anew
  rm -f "$name.rounds"/*.*
  seed "$model" "${allow[@]}" -o "$name.rounds/0.grid"
  cp "$name.rounds/0.grid" "$name.rounds/seeds"
fi
while n=$(basename -a -s .grid "$name.rounds"/*.grid | sort -n | tail -n 1) && now=$name.rounds/$n &&
  [[ $(stats --get todo "$now.grid") != 0 ]]; do
  "${launcher[@]}" expand "$now.grid" --part auto -j "${SLURM_CPUS_PER_TASK:-1}" \
    -o "$now.requests.{}" ${ALLOW:+--allow-process "$model"} </dev/null 9>&-
  seq -f "$now.requests.%.0f-of-$parts" "$parts" | xargs -d '\n' merge -o "$name.rounds/$((n + 1)).grid" "$now.grid"
  rm "$now".*
done
cp "$now.grid" "$name.grid.new"
mv "$name.grid.new" "$name.grid"
