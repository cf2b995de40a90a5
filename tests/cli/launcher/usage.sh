# A mistake in a command line: one line, exit code 2, and nothing is read or written. Options that one filter alone has
# are in its own folder; help.sh looks at the help.
source "$(dirname "$0")/../lib.sh"

seed "$ball" -o seeds
expand seeds -o requests
usage() { expect 2 '' "~$1: .* \(see $1 --help\)" -- "$@"; }
for tool in seed expand merge verify stats play view check-model; do usage $tool seeds -o out --nix; done

usage seed
usage seed "$ball" "$ball"
usage seed "$ball" --set
usage seed "$ball" -o
expect 2 '' "seed: --set: 'grid' is not like KEY=VALUE (see seed --help)" -- seed "$ball" --set grid
expect 2 '' "seed: --set: '=1' is not like KEY=VALUE (see seed --help)" -- seed "$ball" --set =1
refuses "seed: --set grid..x=1: an empty key" -- seed "$ball" --set grid..x=1
refuses "seed: --set grid.spacing.x=1: spacing is no table" -- seed "$ball" --set grid.spacing.x=1
refuses "seed: --set grid.spacing=1.*" -- seed "$ball" --set $'grid.spacing=1\nmodel.plugin="x"'

for part in 0/3 4/3 1 1/0 0/0 -1/3 1/-3 1/3x ' 1/3' 1//3 /3 1/ x '' 1/4294967296 \
  18446744073709551617/18446744073709551618; do
  usage expand seeds -o out --part "$part"
done
for threads in -1 1025 x 1.5 ''; do usage expand seeds -o out -j "$threads"; done
usage expand seeds -o out --complete --part 1/2
usage expand seeds seeds -o out
usage merge --small seeds requests -o out
usage merge seeds - - -o out
nothing_left . seeds requests
# Progress is shown on a terminal, never in a log.
expect 0 '' '' -- expand --complete seeds -o out

# What a long command needs is looked for before it begins: here, without a module.
for command in molecule:scipy table:matplotlib dock:scipy; do
  module=${command#*:} command=${command%:*}
  refuses "$command: .*$module.* missing: install the Debian packages? .*python3-$module.*, or .*by pip install 'hapgrid.$command.'" -- \
    /usr/bin/python3 -c 'import runpy, sys
sys.path.insert(0, sys.argv.pop(1))
sys.modules[sys.argv.pop(1)] = None
runpy.run_module("hapgrid.apps." + sys.argv.pop(1), run_name="__main__")' "$HAPGRID_BIN/../python" $module $command nowhere -o dir
  [[ ! -e dir ]] || fail "$command began"
done

