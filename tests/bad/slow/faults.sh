#!/bin/bash
# The same with many more limits, and a full disk at each byte.
FAULTS=all exec bash "$(dirname "$0")/../faults.sh" "$@"
