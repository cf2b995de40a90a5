#!/bin/bash
# Puts the most useful of what run.sh found into the corpora: at most 24 inputs a target, 4 KiB each,
# that reach what the others there do not. Those of the time before, corpus/TARGET/found-NUMBER, go.
#
#   tests/fuzz/keep-found.sh [TARGET...]
set -euo pipefail
source=$(cd "$(dirname "$0")" && pwd)
build=${HAPGRID_FUZZ:-$source/../../build-dev}/fuzz
(($#)) || set -- $(cd "$source/corpus" && ls)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for target in "$@"; do
  corpus=$source/corpus/$target
  rm -f "$corpus"/found-[0-9]*
  [[ -d $build/found/$target ]] || continue
  "$source/corpus.sh" "$target" "$work/$target"
  mkdir "$work/small"
  find "$build/found/$target" -type f -size -4097c -exec cp -t "$work/small" {} +
  nice -n 15 "$build/fuzz_$target" -set_cover_merge=1 "$work/$target" "$work/small" \
    >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
  rm -rf "$work/small"
  number=0
  # The greedy algorithm writes the input that adds most first.
  while read -r file; do
    [[ ! -e $corpus/$file && $file != example-* ]] || continue
    ((++number <= 24)) || break
    cp "$work/$target/$file" "$corpus/found-$number"
  done < <(ls -tr --time=ctime "$work/$target")
done
