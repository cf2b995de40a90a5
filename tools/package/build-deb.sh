#!/bin/bash
# Builds the Debian package FILE from a checkout, with what Debian 12 lacks for it. The checkout stays as it is.
#
#   tools/package/build-deb.sh FILE
set -euo pipefail
file=$(realpath "$1")
cd "$(dirname "$0")/../.."
.ci/packages demo build package
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
cmake -G Ninja -S . -B "$build" -D CMAKE_BUILD_TYPE=Release -D BUILD_TESTING=OFF
cmake --build "$build"
(cd "$build" && cpack -G DEB -B out)
mv "$build"/out/*.deb "$file"
