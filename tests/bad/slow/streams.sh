# The same with each filter that reads such a shard.
STREAMS=all exec bash "$(dirname "$0")/../streams.sh" "$@"
