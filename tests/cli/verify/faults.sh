# Faults inside streams that are whole: a grid is taken apart with the stock tools, changed, and put
# together again with the right digest, so that only verify can find what is wrong.
source "$(dirname "$0")/../lib.sh"
command -v xxhsum >/dev/null || skip "xxhsum (package xxhash) is not installed"

# Three points in a row; the seeds are its ends.
seed "$ball" --set 'grid.counts=[3,1,1]' --set 'grid.origin=[-0.9,0.0,0.0]' | expand --complete -o grid

# digest FILE: its XXH3-128 as 32 hexadecimal digits, the high word first.
digest() { xxhsum -H128 <"$1" | cut -c1-32; }

# set_digests MESSAGE CHUNK SECTION: the footer with these digests of its one chunk and of itself.
set_digests() {
  local words=() hex
  for hex in "${@:2}"; do
    words+=("\"digestLow\":\"$(printf %u "0x${hex:16}")\",\"digestHigh\":\"$(printf %u "0x${hex:0:16}")\"")
  done
  local old='"digestLow":"[0-9]*","digestHigh":"[0-9]*"'
  sed -E "s/$old(.*)$old/${words[0]}\1${words[1]}/" <<<"$1"
}

# forge SED NAME: `grid` with its record chunk changed by the sed script, as a file.
forge() {
  local messages number chunk
  rm -rf forged && mkdir forged
  mapfile -t messages < <(decode grid)
  [[ ${#messages[@]} == 3 ]] || fail "the grid has ${#messages[@]} messages"
  messages[1]=$(sed -E "$1" <<<"${messages[1]}")
  write() { capnp convert json:binary "$schema" Message >"forged/$1"; }
  write 0 <<<"${messages[0]}"
  write 1 <<<"${messages[1]}"
  # The section's digest is that of the header and of the chunk's digest, low byte first.
  chunk=$(digest forged/1)
  { cat forged/0; printf "$(fold -w2 <<<"$chunk" | tac | sed 's/^/\\x/' | tr -d '\n')"; } >forged/all
  set_digests "${messages[2]}" "$chunk" "$(digest forged/all)" | write 2
  for number in 0 1 2; do zstd -q --check --stdout "forged/$number"; done >"$2"
}

# broken VERDICT OFFENDERS: what verify says of the file `bad`, first offenders and verdict.
broken() {
  local code=0
  verify bad --recompute all >found 2>err || code=$?
  same "exit code" 3 "$code"
  same "verdict" "verify: broken: $1" "$(cat err)"
  # Behind these come the slopes and losses, which are no offenders.
  same "offenders" "$2" "$(sed '/^steep:/,$d' found | grep '^  ')"
}

forge '' bad
expect 0 "$(verify grid 2>/dev/null)" 'verify: fine: 11 checks' -- verify bad

forge 's/"links":\[(255,){13}0/"links":[255,255,255,255,255,255,255,255,255,255,255,255,255,3/' bad
broken 'links (1 of 78), paths (1 of 2)' \
  '  point 0 (0, 0, 0) level 0 direction 13 (1, 0, 0): destination level 3, but point 1 (1, 0, 0) has 1 levels
  start in cell (0, 0, 0) needs point 0 (0, 0, 0) level 0 direction 13 (1, 0, 0)'

forge 's/"generation":\[0,1,0\]/"generation":[0,1,1]/' bad
broken 'generations (1 of 3)' '  point 2 (2, 0, 0) level 0: generation 1, distance 2'

forge 's/"state":\[0,0,0\]/"state":[0,0.5,0]/' bad
broken 'fidelity (2 of 4)' \
  '  point 0 (0, 0, 0) level 0 direction 13 (1, 0, 0): C gives 0, stored at level 0 is 0.5
  point 2 (2, 0, 0) level 0 direction 12 (-1, 0, 0): C gives 0, stored at level 0 is 0.5'

forge 's/"state":\[0,0,0\]/"state":[0,"NaN",0]/' bad
broken 'finite (1 of 3)' '  point 1 (1, 0, 0) level 0: component 0 is nan'
