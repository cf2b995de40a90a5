source "$(dirname "$0")/cli/lib.sh"
m=$HAPGRID_SOURCE/examples/molecule/alanine-dipeptide/alanine-dipeptide.toml
sp=$(seed "$m" | stats --get box.spacing | awk '{ printf "%.17g", $1 * 29 / 11 }')
for s in 0.05 0.025 0.2; do seed "$m" --set 'grid.counts=[12,12,12]' --set "grid.spacing=$sp" --set search.tears=false --set model.parameters.substep=$s | expand --complete -j 2 -o g; echo $s $(stats --get records g) $(stats --get one_way_links g); done
