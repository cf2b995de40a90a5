# A grid in layers: each merge writes what it settles, and the new frontier apart. The layers are the
# grid, and one merge makes them one shard, with the bytes of one process.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set 'grid.counts=[48,32,32]' --set grid.spacing=0.03 --set 'grid.origin=[-0.705,-0.465,-0.465]' -o seeds
expand --complete seeds -j 2 -o whole

# Rounds in layers, each K-th of which makes a new ground of what there is.
rounds() {
  local every=$1 k=0 layers=()
  cp seeds tip
  rm -f layer.*
  while (($(stats --get frontier tip) > 0)); do
    k=$((k + 1))
    expand tip -o requests
    if ((k % every == 0)); then
      merge "${layers[@]}" tip requests --tip next -o layer.$k
      rm -f "${layers[@]}"
      layers=()
    else
      merge "${layers[@]}" tip requests --layer --tip next -o layer.$k
    fi
    layers+=(layer.$k)
    mv next tip
  done
  merge tip "${layers[@]}" -o joined
  cmp joined whole || fail "other bytes with a new ground every $every rounds"
}
rounds 1
rounds 5
rounds 1000

# Each record is in one layer alone; readers take them all, in any order.
same "records" "$(stats --get records whole)" \
  "$(for layer in layer.*; do stats --get records $layer; done | awk '{ n += $1 } END { print n }')"
stats --dump layer.* tip | cmp - <(stats --dump whole)
verify layer.* >/dev/null

# What a layer is about and what it is not: the frontier that was settled, and no other record.
seed "$ball" --set 'grid.counts=[12,8,8]' -o small
expand small | merge small - --tip tip.1 -o ground.1
same "settled" 8 "$(stats --get records ground.1)"
same "left" 0 "$(stats --get frontier ground.1)"
same "new" "$(stats --get records tip.1)" "$(stats --get frontier tip.1)"
expand tip.1 -o requests.1
expand ground.1 tip.1 | cmp - requests.1
merge ground.1 tip.1 requests.1 --layer --tip tip.2 -o layer.2 --frontier frontier.2
same "settled" "$(stats --get records tip.1)" "$(stats --get records layer.2)"
expand frontier.2 | cmp - <(expand tip.2)
merge ground.1 tip.1 requests.1 -o merged
merge ground.1 layer.2 tip.2 -o joined 2>err && fail 'a merge without requests'
expand tip.2 | merge tip.2 layer.2 ground.1 - -o joined
expand merged | merge merged - -o next
cmp joined next

refuses 'merge: merged: the frontier is in one shard with other records; --layer takes .*' \
  -- merge merged --layer --tip t -o out

# A tip that is not given.
refuses 'merge: requests: point [0-9]+ \(.*\) level 0, direction [0-9]+: the grid.s frontier asks for no such conversion' \
  -- merge ground.1 requests.1 -o out
expect 2 '' 'merge: --layer needs --tip (see merge --help)' -- merge small requests.1 --layer -o out
expect 2 '' 'merge: --final and --tip exclude each other (see merge --help)' -- merge --final merged --tip t -o out
[[ ! -e out && ! -e t ]] || fail 'a half merge'
