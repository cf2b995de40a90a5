# The same for each tool, with many more limits, and a full disk at each byte.
FAULTS=all exec bash "$(dirname "$0")/../faults.sh" "$@"
