# A session with the keyboard, in a pseudo terminal; the terminal is given back afterwards.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
settings offset.toml 'mapping.offset = [0.3, 0.2, 0.1]'
python3 - <<'PYTHON'
import os, pty, re, select, signal, sys, termios, time

def session(keys, ending, extra=(), ticks=0.1):
    """Plays with `keys` pressed one by one, after so many seconds of ticks; returns exit code and
    standard error."""
    pid, terminal = pty.fork()
    if pid == 0:
        error = os.open("err", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(error, 2)
        os.execvp("play", ["play", "grid", "--device", "keys", "--rate", "200", "--log", "log.session",
                           *extra])
    before = None
    deadline = time.monotonic() + 30
    # The terminal is raw once play reads it: until then a key would only be echoed.
    while time.monotonic() < deadline:
        mode = termios.tcgetattr(terminal)[3]
        if not mode & termios.ICANON:
            break
        before = mode
        time.sleep(0.01)
    else:
        sys.exit("the terminal never became raw: " + open("err").read())
    # The loop, which begins some time later, announces itself.
    while ticks and time.monotonic() < deadline and " Hz; " not in open("err").read():
        time.sleep(0.01)
    time.sleep(ticks)
    for key in keys:
        os.write(terminal, key)
        time.sleep(0.02)
    if keys:
        time.sleep(0.3)  # the HIP follows with a time constant of 50 ms
    ending(pid, terminal)
    _, status = os.waitpid(pid, 0)
    after = termios.tcgetattr(terminal)[3]
    assert after & termios.ICANON and after & termios.ECHO, after
    return os.waitstatus_to_exitcode(status), open("err").read()

def hips():
    os.system('python3 "$HAPGRID_SOURCE/tests/cli/stats/session.py" text log.session >log.txt')
    rows = [line.split("\t") for line in open("log.txt") if not line.startswith("#")]
    return [tuple(map(float, row[1:4])) for row in rows]

code, error = session([b"\x1b[C", b"\x1b[C", b"\x1bOA", b"\x1b[6~"],
                      lambda pid, terminal: os.write(terminal, b"q"))
assert code == 0, (code, error)
assert re.match(r"play: keys at 200 Hz; real time: .*\n", error), error
path = hips()
# From the middle of the box, steps of half the spacing: two in x, one up z, one down y.
start, end = path[0], path[-1]
wanted = (start[0] + 0.1, start[1] - 0.05, start[2] + 0.05)
assert all(abs(a - b) < 5e-3 for a, b in zip(end, wanted)), (start, end, wanted)
# No step of a key is a jump of the HIP: 0.05 with 50 ms is at most 1 a second.
assert all(abs(b[a] - a_[a]) < 0.05 for a_, b in zip(path, path[1:]) for a in range(3))

code, error = session([b"\x1b[D"], lambda pid, terminal: os.write(terminal, b"\x03"))
assert code == 130, (code, error)
code, error = session([], lambda pid, terminal: os.kill(pid, signal.SIGTERM))
assert code == 143, (code, error)
code, error = session([], lambda pid, terminal: os.write(terminal, b"q"),
                      ["--config", "offset.toml"])
moved = (0.3 + start[0], 0.2 + start[1], 0.1 + start[2])  # from the middle of the box
assert code == 0 and all(abs(a - b) < 1e-9 for a, b in zip(hips()[0], moved)), (code, error, hips()[0])
# Before the first tick: the terminal is raw, and the pipe for the frames has no reader. Signals are
# sent until one comes while it waits for that; one more, on the way out, finds no handler any more
# (session() has looked that the terminal is given back). A shell says 130 of both.
def interrupt(pid, terminal):
    for _ in range(200):
        os.kill(pid, signal.SIGINT)
        time.sleep(0.05)
        if os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT | os.WNOHANG):
            return
    os.kill(pid, signal.SIGKILL)

os.mkfifo("pipe")
code, error = session([], interrupt, ["--frames", "pipe"], ticks=0)
assert code in (130, -signal.SIGINT) and error == "", (code, error)
PYTHON
# Without a terminal there are no keys.
refuses 'play: keys: there is no terminal to read \(with ssh use -t\)' \
  -- setsid -w play grid --device keys
