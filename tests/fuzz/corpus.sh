#!/bin/bash
# Copies what a target begins with into a folder: its corpus and, of `texts`, the definitions and profiles of the examples.
#
#   tests/fuzz/corpus.sh TARGET FOLDER
set -euo pipefail
source=$(cd "$(dirname "$0")" && pwd)
rm -rf "$2"
mkdir -p "$2"
cp "$source/corpus/$1"/* "$2"
[[ $1 == texts ]] || exit 0
for file in "$source"/../../examples/{hung-ball/hung-ball{,-process},soft-tissue/soft-tissue,molecule/butane/butane,devices/*}.toml; do
  cp "$file" "$2/example-${file##*/}"
done
