"""What the haptic thread asks of the system between its first tick and its last, from traces of strace -f."""
import collections
import re


def check(name, *more):
    """It sleeps until a time; else only what is allowed: the clock, without a vDSO, and `more`. @return the counts"""
    lines = [line.rstrip("\n").split(None, 1) for line in open(name)]
    mine = [text for pid, text in lines if pid == lines[0][0]]  # the thread that the program began with
    # Who waits for the guard at the end sleeps for some time instead.
    sleeps = [i for i, text in enumerate(mine) if text.startswith("clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME")]
    # A call during which another thread made one has two lines. The second begins with "<... ".
    calls = collections.Counter(re.match(r"(\w+)|.*", text)[1] for text in mine[sleeps[0]:sleeps[-1]]
                                if not text.startswith("<... "))
    assert len(sleeps) > 50 and set(calls) <= {"clock_nanosleep", "clock_gettime", *more}, (name, len(sleeps), calls)
    return calls
