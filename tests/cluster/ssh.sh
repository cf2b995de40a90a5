# Parts that GNU parallel starts over ssh.
source "$(dirname "$0")/../cli/lib.sh"
needs sshd openssh-server
needs ssh openssh-client
needs parallel parallel
[[ $(id -u) == 0 ]] || skip "an sshd of one's own is started as root"

# An sshd with a key and a port of its own, which knows nobody but this test. Its logins have an empty home: what this
# machine's .bashrc writes at a login is none of the command's.
mkdir -p -m 700 ssh home
[[ -d /run/sshd ]] || mkdir -p /run/sshd
ssh-keygen -q -t ed25519 -N '' -f ssh/host
ssh-keygen -q -t ed25519 -N '' -f ssh/key
port=$((31300 + $$ % 1400))
cat >ssh/sshd_config <<END
Port $port
ListenAddress 127.0.0.1
HostKey $PWD/ssh/host
AuthorizedKeysFile $PWD/ssh/key.pub
PidFile $PWD/ssh/pid
StrictModes no
UsePAM no
PasswordAuthentication no
PermitRootLogin prohibit-password
MaxStartups 100
SetEnv HOME=$PWD/home
END
for host in one two; do
  cat <<END
Host $host
  HostName 127.0.0.1
  Port $port
  IdentityFile $PWD/ssh/key
  UserKnownHostsFile $PWD/ssh/known
  StrictHostKeyChecking accept-new
END
done >ssh/config
/usr/sbin/sshd -D -f "$PWD/ssh/sshd_config" -E "$PWD/ssh/log" &
daemon=$!
trap 'kill $daemon 2>/dev/null; rm -rf "$work"' EXIT
evidence() { cat ssh/log; }
wait_for 20 "sshd" ssh -F ssh/config one true

# What a login over there does not have, the command brings: this plug-in is found by HAPGRID_MODEL_PATH.
mkdir plugins
cp "$(readlink -f "$HAPGRID_BIN/../models")/hung-ball.so" plugins/over-there.so
export HAPGRID_MODEL_PATH=$PWD/plugins PARALLEL_HOME=$PWD/home PARALLEL_SSH="ssh -F $PWD/ssh/config"
sed 's/^plugin = .*/plugin = "over-there"/; s/^counts = .*/counts = [4, 6, 6]/; s/^spacing = .*/spacing = 0.15/' "$ball" >my.toml
seed my.toml | expand --complete -o reference
examples=$HAPGRID_SOURCE/examples/cluster
expect 0 '~.*' '' -- hapgrid rounds my.toml -- "$examples/parallel.sh" 2/one,2/two 5
cmp my.grid reference
