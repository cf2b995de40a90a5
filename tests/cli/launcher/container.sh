#!/bin/bash
# The Dockerfile and the definition for Apptainer do the same, with what is there; slow/container.sh does it.
source "$(dirname "$0")/../lib.sh"
package=$HAPGRID_SOURCE/tools/package
python3 "$here/container.py" "$package/Dockerfile" >docker
python3 "$here/container.py" "$package/hapgrid.def" >apptainer
python3 - "$HAPGRID_SOURCE" <<'PYTHON'
import json
import os
import sys
docker, apptainer = json.load(open("docker")), json.load(open("apptainer"))
assert len(docker) == len(apptainer) == 2, (docker, apptainer)
for one, two in zip(docker, apptainer):
    for stage in one, two:  # a folder as a destination means the same name there
        stage["copy"] = [[s, s if d == "/" else d, origin] for s, d, origin in stage["copy"]]
        # An environment of one command, and what a RUN line cannot leave to the next one.
    assert one["from"] == two["from"] == "debian:bookworm" and one["copy"] == two["copy"], (one, two)
    assert one["run"] == two["run"] and one["run"], (one["run"], two["run"])
    assert one["start"] == two["start"], (one, two)
build, final = docker
assert final["start"] == "hapgrid" and build["start"] is None
(source, there, origin), = build["copy"]
assert source == "." and origin is None
# What is called in the copy of the checkout is there; what it leaves is what the second stage copies and installs.
(command, deb), = [run.split() for run in build["run"]]
assert os.access(command.replace(there, sys.argv[1], 1), os.X_OK), command
assert final["copy"] == [[deb, deb, 0]] and any(run.endswith(f"install -y -qq --install-recommends {deb}") for run in final["run"])
# Nothing that the build needs is left out of the copy.
ignored = [line.strip() for line in open(os.path.join(sys.argv[1], ".dockerignore")) if not line.startswith("#")]
assert ignored == [".git", "build*"], ignored
PYTHON
