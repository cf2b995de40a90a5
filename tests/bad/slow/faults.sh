#!/bin/bash
# The same at every system call.
FAULTS=all exec bash "$(dirname "$0")/../faults.sh" "$@"
