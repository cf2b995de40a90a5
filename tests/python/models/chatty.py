"""A model of functions and arrays of numpy that prints, in Python and beneath it, and starts what reads its input."""
import os
import subprocess
import types
import hapgrid
import numpy as np

print("before serve")


def chatty(fault=""):
    def convert(s, x, d):
        print("converting")
        os.write(1, b"from beneath\n")
        assert subprocess.run(["cat"], capture_output=True, check=True).stdout == b""
        if fault == "key" and x[0] > 0:
            {}["gone"]  # KeyError
        if fault == "said" and x[0] > 0:
            raise ValueError("nothing is known\nbeyond 0")
        if fault == "nan" and x[0] > 0:
            return np.array([np.nan, 0])
        return (np.array(x) + d)[:2] / 2

    def known_states(x):
        return [np.array(x[:2]) / 2]

    if fault == "refused":
        raise ValueError("no fault is refused")
    return types.SimpleNamespace(
        description={"state_size": 2, "d_max": 2, "tolerance": 1e-6}, convert=convert, known_states=known_states,
        force=lambda s, x: [-s[0], -s[1], np.float32(0.5)])


hapgrid.serve(chatty)
