#!/bin/bash
# The rules of house-style.md that no compiler checks: which folder of libcore may include which,
# who may use capnp and zstd, and that libcore never prints or exits. Run with a directory, it looks
# at that one instead.
set -euo pipefail
cd "${1:-${HAPGRID_SOURCE:-$(dirname "$0")/..}}"

# What a folder may include besides itself.
declare -A allowed=(
  [base]=""  # beyond house-style.md: zstd's frames, which shards and sessions have in common
  [grid]="base"
  [model]="base grid"
  [shard]="base grid"
  [search]="base grid model shard"
  [follow]="base grid model"
  [check]="base grid model shard search follow"
  [device]="base grid"         # beyond house-style.md: a device's positions are grid's Vec3
  [loop]="base grid device follow"  # of follow/ the interface of a traversal alone
  [scene]="base grid"
  [session]="base grid device"
)

bad=0
complain() {
  echo "$1" >&2
  bad=1
}

sources() { find "$@" -name '*.[hc]pp' -o -name '*.[hc]' | sort; }

for file in $(sources libcore); do
  folder=${file#libcore/}
  folder=${folder%%/*}
  [[ -v allowed[$folder] ]] || complain "$file: folder $folder is not in $0"
  while read -r include; do
    path=${include#*[<\"]}
    path=${path%%[>\"]*}
    case $path in
      libcore/*)
        [[ -e $path ]] || complain "$file: includes $path, which is not there"
        to=${path#libcore/}
        to=${to%%/*}
        [[ $to == "$folder" || " ${allowed[$folder]} " == *" $to "* ]] ||
          complain "$file: $folder must not include $to ($path)"
        ;;
      zstd*.h | xxh*.h)
        [[ $folder == base ]] ||
          complain "$file: base/ has frames and digests ($path)"
        ;;
      capnp/* | kj/* | *.capnp.h)
        [[ $folder == shard || $folder == scene || $folder == session || $file == libcore/base/@(message|kj_equality).hpp ]] ||
          complain "$file: only shard/, scene/, session/, base/message.hpp and base/kj_equality.hpp use $path"
        ;;
      png.h)
        [[ $folder == scene ]] || complain "$file: only scene/ uses $path"
        ;;
      hidapi* | libevdev/*)
        complain "$file: only adapters (tools/devices/) use $path"
        ;;
      iostream | cstdio | stdio.h | print | syncstream)
        # plugin.hpp is compiled into plug-ins, and snprintf() is no printing.
        [[ $file == libcore/model/plugin.hpp ]] || complain "$file: libcore never prints ($path)"
        ;;
      tools/* | tests/* | examples/*)
        complain "$file: libcore stands below $path"
        ;;
      */*)
        ;;
      *)
        # Ours carry the full path.
        # plugin.hpp is public, and lies in hapgrid/ beside plugin.h.
        [[ $include == *\"* && $path != *.capnp.h && $file != libcore/model/plugin.hpp ]] && complain "$file: includes \"$path\" without its path"
        ;;
    esac
  done < <(grep -hE '^[[:space:]]*#[[:space:]]*include' "$file" || true)
  # A source includes its own header first.
  if [[ $file == *.cpp && -e ${file%.cpp}.hpp ]]; then
    first=$(grep -m1 '^#include' "$file")
    [[ $first == "#include \"${file%.cpp}.hpp\"" ]] || complain "$file: its own header is not first"
  fi
  [[ $file != *.hpp ]] || grep -q '^#pragma once' "$file" || complain "$file: no #pragma once"
  # Comments aside; std::exit, exit(, _exit(, abort(, quick_exit(, and printing.
  if sed -E -e 's://.*$::; s:/\*.*\*/::; /^[[:space:]]*\*/d' "$file" |
    grep -nE '(^|[^[:alnum:]_>.])(std::)?(_?exit|_Exit|quick_exit|abort|terminate|v?f?printf|puts|fputs|perror)[[:space:]]*\(|std::(cout|cerr|clog)' >&2; then
    complain "$file: libcore never prints nor exits"
  fi
done

# loop, device and model meet only in play.
for file in $(sources tools); do
  folders=$(sed -nE 's:^#include "libcore/(loop|device|model)/.*:\1:p' "$file" | sort -u | wc -l)
  if ((folders == 3)) && [[ $file != tools/play.cpp && $file != tools/play/* ]]; then
    complain "$file: loop, device and model meet only in play"
  fi
done
exit $bad
