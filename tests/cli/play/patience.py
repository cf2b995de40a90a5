"""A machine that stands still for 100 ms makes play let go of the device, as it should. What this has spoilt gets another
attempt: as in_time of cli/lib.sh, which says how attempts are counted."""
import os
import sys
import threading


def whole(name, text):
    """Writes a file that others may be reading, at once."""
    part = f"{name}.{threading.get_ident()}"
    with open(part, "w") as file:
        file.write(text)
    os.replace(part, name)


def ramp(ms):
    """Options of play with this ramp, and the line that it begins with."""
    name = f"ramp{ms}.toml"
    whole(name, f"[play]\nsafety.ramp = {ms}\n")
    return ["--config", name], f"play: {name} sets safety.ramp = {ms}\n"


class Busy(Exception):
    """The machine stood still, or was too busy for what was to be seen."""


def patiently(attempt, *arguments):
    """The result of the first of five attempts that is not Busy. A rule that is broken is broken in each."""
    for number in range(1, 6):
        if "HAPGRID_ATTEMPTS" in os.environ:
            with open(os.environ["HAPGRID_ATTEMPTS"], "a") as counted:
                counted.write(f"{os.path.basename(sys.argv[0])} {number}\n")
        try:
            return attempt(*arguments)
        except Busy as why:
            print(f"RETRIED: attempt {number} of 5: the machine stood still: {arguments} {why}")
            if number == 5:
                raise
