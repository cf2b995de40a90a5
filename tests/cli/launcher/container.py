"""container.py FILE: what a Dockerfile or a definition for Apptainer does, as JSON: a list of its stages, each with the
image `from`, what it copies (`copy`: source, destination and the stage that it comes from or null), its commands (`run`),
and what is started in the end (`start`). What is not understood is an error, so that nothing is left out unseen.
"""
import json
import re
import sys


def dockerfile(text):
    stages, names = [], []
    for line in re.sub(r"\\\n\s*", "", text).splitlines():
        word, _, rest = line.strip().partition(" ")
        if not word or word.startswith("#"):
            continue
        if word == "FROM":
            image, _, name = rest.partition(" AS ")
            stages.append({"from": image, "copy": [], "run": [], "start": None})
            names.append(name)
        elif word == "COPY":
            *options, source, destination = rest.split()
            sources = [names.index(o.removeprefix("--from=")) for o in options]
            stages[-1]["copy"].append([source, destination, sources[0] if sources else None])
        elif word == "RUN":
            stages[-1]["run"] += rest.split(" && ")
        elif word == "ENTRYPOINT":
            stages[-1]["start"] = " ".join(json.loads(rest))
        elif word != "WORKDIR":
            sys.exit(f"what is {word}?")
    return stages


def apptainer(text):
    stages, names, section = [], [], None
    for line in text.splitlines():
        line = line.strip()
        key, _, value = line.partition(": ")
        if not line or line.startswith("#"):
            continue
        if key == "Bootstrap":
            assert value == "docker", value
            stages.append({"from": None, "copy": [], "run": [], "start": None})
            names.append(None)
            section = None
        elif key == "From":
            stages[-1]["from"] = value
        elif key == "Stage":
            names[-1] = value
        elif line.startswith("%"):
            section, _, origin = line.partition(" from ")
        elif section == "%files":
            stages[-1]["copy"].append([*line.split(), names.index(origin) if origin else None])
        elif section == "%post":
            stages[-1]["run"].append(line)
        elif section == "%runscript":
            stages[-1]["start"] = line.removeprefix("exec ").removesuffix(' "$@"')
        elif section != "%test":
            sys.exit(f"what is {line}?")
    return stages


with open(sys.argv[1], encoding="utf-8") as file:
    print(json.dumps((apptainer if sys.argv[1].endswith(".def") else dockerfile)(file.read())))
