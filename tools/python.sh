#!/bin/sh
# Starts the program in Python that has this file's name. The system's Python is named by its path, and PYTHONPATH is not
# obeyed (-E): its modules are Debian packages, which another Python does not see, and those of another Python do not work
# in it. The package's folder may be read only (-B).
here=$(readlink -f "$0")
bin=$(dirname "$here")
exec /usr/bin/python3 -E -B "$(dirname "$bin")/python" "${here##*/}" "$@"
