# A grid in ranges of points: requests by the range of their target, each range merged by itself and
# rewritten only where the frontier is. Put together it has the bytes of one process, whatever the
# number of ranges; a lost shard is missed.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set 'grid.counts=[48,24,24]' --set grid.spacing=0.04 --set 'grid.origin=[-0.945,-0.465,-0.465]' -o seeds
expand --complete seeds -j 2 -o whole

frontier() { stats --get frontier "$@"; }

# Rounds of a grid in $1 ranges with requests in two parts; what a merge is given are the ranges
# beside it (reach: a plane and a bit; a range is 6 planes or more).
rounds() {
  local ranges=$1 generation=0 k rewritten=0 all=0
  rm -rf r && mkdir r
  cp seeds r/grid.all
  while (($(frontier r/grid.*) > 0)); do
    rm -rf new && mkdir new
    for part in 1 2; do expand --part "$part/2" r/grid.* --ranges "$ranges" -o "new/requests.$part.{}"; done
    for ((k = 1; k <= ranges; ++k)); do
      all=$((all + 1))
      local grid=() requests=() near
      for ((near = k - 2; near <= k + 2; ++near)); do
        [[ -e r/grid.$near ]] && grid+=("r/grid.$near")
        for part in 1 2; do
          [[ -e new/requests.$part.$near ]] && requests+=("new/requests.$part.$near")
        done
      done
      [[ -e r/grid.all ]] && grid=(r/grid.all)
      # Nothing for this range, and nothing of it was in the frontier: it stays what it is.
      if [[ ! -e r/grid.all ]] && ! compgen -G "new/requests.*.$k" >/dev/null &&
        (($(frontier "r/grid.$k") == 0)); then
        cp "r/grid.$k" "new/grid.$k"
        continue
      fi
      rewritten=$((rewritten + 1))
      merge --range "$k/$ranges" "${grid[@]}" "${requests[@]}" -o "new/grid.$k"
    done
    rm -rf r && mv new r
    rm -f r/requests.*
    generation=$((generation + 1))
  done
  merge r/grid.* -o joined
  cmp joined whole || fail "$ranges ranges: other bytes"
  echo "$rewritten of $all ranges rewritten in $generation rounds"
}
rounds 4 >said
cat said
awk '{ exit !($1 < $3) }' said || fail "all ranges were rewritten in each round: $(cat said)"
rounds 3

# Every reader takes the ranges as they are, in any order.
[[ $(stats --get records r/grid.3 r/grid.1 r/grid.2) == $(stats --get records whole) ]] || fail records
stats --dump r/grid.2 r/grid.3 r/grid.1 | cmp - <(stats --dump whole)

# A lost shard of requests, or a range that is not given.
expand seeds | merge seeds - -o one
expand --part 1/2 one --ranges 4 -o 'q.1.{}'
expand --part 2/2 one --ranges 4 -o 'q.2.{}'
k=1
while [[ ! -e q.1.$k && ! -e q.2.$k ]]; do k=$((k + 1)); done
present=(q.?.*)
merge --range "$k/4" one "${present[@]}" -o kept
for lost in "${present[@]}"; do
  [[ $lost == *.$k ]] || continue
  left=()
  for other in "${present[@]}"; do [[ $other == "$lost" ]] || left+=("$other"); done
  refuses 'merge: requests are missing: [0-9]+ of the [0-9]+ conversions of generation 1, the first from .*' \
    -- merge --range "$k/4" one "${left[@]}" -o out
done
[[ ! -e out ]] || fail 'a merge without all requests'

# What is new in a range, as the whole merge and the shards say it.
expand seeds -o all
merge seeds all -o new --frontier new.frontier --counts counts
expand new.frontier | cmp - <(expand new)
same "counts" "$(printf '1\t%s\t%s\t%s' "$(($(stats --get points_reached new) - 8))" \
  "$(stats --get frontier new)" "$(stats --get conversions_left new)")" "$(cat counts)"
for k in 1 2 3 4; do merge --range $k/4 seeds all -o /dev/null --counts counts.$k; done
same "sums" "$(cut -f 2- counts)" "$(awk '{ p += $2; r += $3; c += $4 } END { print p "\t" r "\t" c }' counts.[1-4])"
same "numbers" "1 2 3 4" "$(cut -f 1 counts.[1-4] | paste -sd ' ')"
merge new.frontier 2>/dev/null && fail 'a frontier for a grid'

# How it is cut: 65,536 points in chunks of 1,024, planes of 2,048. With 26 neighbours a range reaches a
# plane, a row and a point away; twice that far, 4,226 points, it depends on the records beside it.
seed "$ball" --set 'grid.counts=[64,32,32]' --set grid.spacing=0.03 --set 'grid.origin=[-0.945,-0.465,-0.465]' -o cut
same "ranges" "$(printf '%s\t' 1 0 32768 1 2)
$(printf '%s\t' 2 32768 65536 1 2)" "$(stats --ranges 2 cut | sed 's/$/\t/')"
same "ranges" "1 1 2,2 1 3,3 2 4,4 3 4" "$(stats --ranges 4 cut | cut -f 1,4,5 | tr '\t' ' ' | paste -sd ,)"
same "ranges of a chunk each" "1 1 6,32 27 37,64 59 64" \
  "$(stats --ranges 77 cut | cut -f 1,4,5 | tr '\t' ' ' | sed -n '1p;32p;$p' | paste -sd ,)"
expect 2 '' '~stats: --ranges: .*' -- stats --ranges 0 seeds
expect 2 '' '~stats: --get, --dump, --slice, --ranges and --log exclude each other .*' -- stats --ranges 2 --dump seeds

expect 2 '' "merge: --range: '5/4' is not K/N with 1 <= K <= N < 2^32 (see merge --help)" -- merge --range 5/4 one
expect 2 '' "expand: --output: 'out' has no {} for the number (see expand --help)" -- expand one --ranges 2 -o out
