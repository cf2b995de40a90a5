"""Mutants of what hapgrid reads, drawn anew in each run: one line, below 1 s of a processor and 500 MB, whatever is in them.

mutants.py filters|apps SEED COUNT    prints a line for each kind and command. A finding is kept in HAPGRID_BUILD/mutants.

A mutant depends on SEED, its kind and its number alone. The programs in Python read in this process, or behind their walls: to
start them would take long."""
import glob
import itertools
import json
import os
import random
import re
import resource
import select
import shutil
import signal
import subprocess
import sys
import time
import warnings

part, seed, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
SOURCE, BUILD = os.environ["HAPGRID_SOURCE"], os.environ["HAPGRID_BUILD"]
SANITIZED = "SANITIZED" in os.environ
# CPU seconds, which a busy machine doubles.
SECONDS, BYTES, PATIENCE = (20, 4 << 30, 120) if SANITIZED else (2, 500 << 20, 30)
# Numbers and words that readers trip over.
WORDS = [b"0", b"-1", b"1e308", b"-1.7e308", b"1e-320", b"nan", b"inf", b"99999999999999999999", b"9" * 5000, b"1e99999", b"4294967296",
         b"2147483647", b"-2147483648", b"0x10", b"1_0", "²".encode(), "\u202e".encode(), b"\x1b[31m", b"\xff\xfe", b"\0", b"", b"[", b"{", b'"', b"'",
         b"]" * 2000, b"[" * 2000, b"<a>" * 500, b" " * 3000, b"\n" * 3000, b"../../x", b"/dev/zero", b"e", b"=", b",", b"1 " * 1000]
failures = []


def mutant(draw, seeds):
    """One to four changes of a text or of bytes."""
    data = draw.choice(seeds)
    for _ in range(draw.choice((1, 1, 2, 4))):
        at, end = sorted((draw.randint(0, len(data)), draw.randint(0, len(data))))
        end = min(end, at + draw.choice((1, 8, 100, 10**9)))
        tokens = list(re.finditer(rb"[^\s,=\[\]{}\"<>]+", data[:1 << 16]))
        how = draw.randrange(9)
        if how < 4 and tokens:  # another word
            word = draw.choice(tokens)
            data = data[:word.start()] + draw.choice((*WORDS, draw.choice(tokens)[0])) + data[word.end():]
        elif how == 4:  # a line or two more or less
            lines = data.split(b"\n")
            k = draw.randrange(len(lines))
            lines[k:k + 1] = draw.choice(([], [lines[k]] * draw.choice((2, 3, 300)), [draw.choice(lines)]))
            data = b"\n".join(lines)
        elif how == 5:
            data = data[:at] + data[end:]
        elif how == 6:
            data = data[:at] + draw.choice((*WORDS, draw.randbytes(8))) + data[end:]
        elif how == 7:
            other = draw.choice(seeds)
            data = data[:at] + other[draw.randint(0, len(other)):]
        elif data:
            k = draw.randrange(len(data))
            data = data[:k] + bytes([data[k] ^ 1 << draw.randrange(8)]) + data[k + 1:]
    return data[:1 << 20]


def texts(*patterns):
    found = [open(name, "rb").read() for pattern in patterns for name in sorted(glob.glob(pattern))]
    assert found, patterns
    return found


def mutants(kind, seeds, number):
    return (mutant(random.Random(f"{seed} {kind} {n}"), seeds) for n in range(number))


def fails(kind, command, n, data, why):
    os.makedirs(f"{BUILD}/mutants", exist_ok=True)
    kept = f"{BUILD}/mutants/{kind}-{seed}-{n}"
    open(kept, "wb").write(data)
    failures.append(f"{kind}, {command}: {why}: {kept}")


def too_much(used):
    """What a child used that is beyond the limits."""
    if used.ru_utime + used.ru_stime > SECONDS:
        return f"{used.ru_utime + used.ru_stime:.2f} s"
    return f"{used.ru_maxrss >> 10} MB" if used.ru_maxrss << 10 > BYTES else ""


def wait(pid):
    """wait4(), which kills a process that takes for ever."""
    handle = os.pidfd_open(pid)
    late = not select.select([handle], [], [], PATIENCE)[0]
    if late:
        os.kill(pid, signal.SIGKILL)
    os.close(handle)
    _, status, used = os.wait4(pid, 0)
    return late, os.waitstatus_to_exitcode(status), used


def filters(kind, file, made, commands):
    """Each mutant, as a file of that name, for each command."""
    said, nothing = os.memfd_create("said"), os.open(os.devnull, os.O_RDWR)
    begun, codes, number = time.process_time() + children(), {}, 0
    for n, data in enumerate(made):
        number = n + 1
        with open(file, "wb") as out:
            out.write(data)
        for words in commands:
            os.ftruncate(said, 0)
            os.lseek(said, 0, os.SEEK_SET)
            pid = os.posix_spawnp(words[0], words, os.environ, file_actions=[(os.POSIX_SPAWN_DUP2, nothing, 0),
                                  (os.POSIX_SPAWN_DUP2, nothing, 1), (os.POSIX_SPAWN_DUP2, said, 2)])
            late, code, used = wait(pid)
            text = os.pread(said, 100000, 0)
            lines = text.rstrip(b"\n").split(b"\n")
            codes[code] = codes.get(code, 0) + 1
            why = "takes for ever" if late else f"exit code {code}" if code not in (0, 1, 2, 3, 4) else too_much(used)
            if not why and code in (1, 2) and (not lines[-1].startswith(words[0].encode() + b": ") or len(lines) > 1 and words[0] != "play"
                                               or len(lines[-1]) > 6000):
                why = f"says {text[:300]!r}"
            if why:
                fails(kind, " ".join(words), n, data, why)
    os.close(said)
    os.close(nothing)
    assert number < 1000 or 0 in codes or kind in ("answers", "profile"), f"{kind}: no mutant is taken: are its originals of another version?"
    print(f"{kind}: {number} mutants for each of {', '.join(sorted({words[0] for words in commands}))}; exit codes {dict(sorted(codes.items()))}, "
          f"{time.process_time() + children() - begun:.0f} s", flush=True)


def children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def verdict(file, data, read, refusals):
    """(whether this mutant was refused, what is wrong)"""
    def late(*_):
        raise TimeoutError
    signal.signal(signal.SIGALRM, late)
    with open(file, "wb") as out:
        out.write(data)
    before, refused, why = time.process_time() + children(), False, ""
    signal.alarm(PATIENCE)
    try:
        with warnings.catch_warnings(record=True) as warned:  # a line more
            warnings.simplefilter("always", RuntimeWarning)
            read(file)
    except refusals as refusal:
        refused = True
        text = str(refusal)  # which is shown by its ends where it is long
        why = f"says {text[:300]!r}" if "\n" in text or "not understood: " in text and "Error" in text else ""
    except BaseException as wrong:  # whatever it is, it is a traceback
        why = f"{type(wrong).__name__}: {wrong}"
    finally:
        signal.alarm(0)
    why = why or (f"warns: {warned[0].message}" if warned else "")
    used = time.process_time() + children() - before
    most = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return refused, why or (f"{used:.2f} s" if used > SECONDS else f"{most >> 10} MB" if most << 10 > BYTES else "")


def read_together(file, batch, read, refusals):
    """The verdict() of each mutant of a batch, in one process behind no walls, until one of them ends it or takes for ever."""
    from hapgrid.apps.common import sandbox

    def run(function, what, *_):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # nobody sees what is said behind the walls
                return function()
        except sandbox.Failed:
            raise
        except (Exception, RecursionError) as why:
            raise sandbox.Failed(f"{what}: not understood: {why}".split("\n", 1)[0]) from None
    ours, its = os.pipe()
    pid = os.fork()
    if pid == 0:
        try:
            sandbox.run = run
            if not SANITIZED:  # a sanitizer takes terabytes of addresses
                resource.setrlimit(resource.RLIMIT_AS, (sandbox.MEMORY, sandbox.MEMORY))
            for data in batch:
                os.write(its, json.dumps(verdict(file, data, read, refusals)).encode() + b"\n")
        finally:
            os._exit(0)
    os.close(its)
    said = b""
    while select.select([ours], [], [], 2 * PATIENCE)[0] and (more := os.read(ours, 1 << 16)):
        said += more
    os.close(ours)
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    return [json.loads(line) for line in said.split(b"\n")[:-1]]


def reads(kind, file, made, read, refusals):
    """Each mutant, as a file of that name, is read by Python. To start a process behind its walls takes ten times longer than to
    read: only each twentieth mutant has one of its own, and each that ends the process of the others."""
    begun, refused, number = time.process_time() + children(), 0, 0
    while batch := list(itertools.islice(made, 20)):
        verdicts = []
        while len(verdicts) < len(batch):
            verdicts.append(verdict(file, batch[len(verdicts)], read, refusals))
            verdicts += read_together(file, batch[len(verdicts):], read, refusals)
        for n, (no, why) in enumerate(verdicts):
            refused += no
            if why:
                fails(kind, "reading", number + n, batch[n], why)
        number += len(batch)
    print(f"{kind}: {number} mutants, {refused} refused, {time.process_time() + children() - begun:.0f} s", flush=True)


def made_of_messages(kind, corpus):
    """Their sizes and digests are right."""
    shutil.rmtree("made", ignore_errors=True)
    os.makedirs("made")
    subprocess.run([f"{BUILD}/tests/mutants", str(seed % 2**31), str(count), "made", *sorted(glob.glob(corpus))], check=True)
    return (open(f"made/{n}", "rb").read() for n in range(count))


def all_filters():
    corpus = f"{SOURCE}/tests/fuzz/corpus"
    played = ["play", "grid", "--device"]
    filters("shard", "m", made_of_messages("shard", f"{corpus}/shard/made-*"), [
        ["stats", "m"], ["verify", "m", "--recompute", "none"], ["merge", "m", "-o", "out"], ["expand", "m", "-o", "out"],
        ["view", "m", "--png", "out.png", "--size", "40x30"], ["play", "m", "--device", "path:path"]])
    filters("session", "m.session", made_of_messages("session", f"{corpus}/session/made-*"), [["stats", "m.session"], [*played, "replay:m.session"]])
    filters("frames", "m", mutants("frames", texts(f"{corpus}/streams/made-frames-*"), count), [["view", "m"], ["view", "m", "--png", "out.png", "--size", "40x30"]])
    filters("definition", "m.toml", mutants("definition", [open("small.toml", "rb").read()], count), [["seed", "m.toml", "-o", "out"]])
    filters("path", "m", mutants("path", texts(f"{corpus}/texts/made-path-*"), count), [[*played, "path:m"]])
    filters("play.toml", "m.toml", mutants("play.toml", texts("play.toml"), count), [[*played, "path:path", "--config", "m.toml"]])
    filters("answers", "answers", mutants("answers", texts(f"{corpus}/process/made-*"), count), [["seed", "process.toml", "--allow-process", "-o", "out"]])
    if not SANITIZED:  # the stand-in for hidapi has no device, which a mutant could harm
        os.environ.update(HAPGRID_STANDIN="none", LD_LIBRARY_PATH=f"{BUILD}/tests/standin")
        filters("profile", "m.toml", mutants("profile", texts(f"{SOURCE}/examples/devices/*.toml"), count),
                [["play", "--device", "hid:m.toml", "--duration", "0.01"]])


def all_apps():
    import hapgrid
    from hapgrid.apps.common.files import Failed
    from hapgrid.apps.common.work import Work
    from hapgrid.apps.dock import field, maps
    from hapgrid.apps.table import readers
    corpus = f"{SOURCE}/tests/fuzz/corpus"
    reads("frames in Python", "m.frames", mutants("frames", texts(f"{corpus}/streams/made-frames-*"), count), hapgrid.read, (ValueError, OSError))
    for kind in "map", "dx", "cube", "vti":
        reads(kind, f"m.{kind}", mutants(kind, texts(f"good*.{kind}"), count), readers.read, Failed)
    ligand = [("C", None, 0.0)]

    def maps_of(path):
        field.host(path)
        field.read(path, ligand)
    reads("fld", "m.maps.fld", mutants("fld", texts("good.maps.fld"), count), maps_of, (Failed, OSError))
    os.makedirs("room", exist_ok=True)
    work = Work("dock", "room", True)

    def docked(path):
        maps.reach(maps.pdbqt(work, path, "ligand", maps.MOST_LIGAND), work.read("ligand.pdbqt"), True)
    for kind in "pdbqt", "pqr", "mol2":
        if kind != "mol2" or shutil.which("obabel"):  # which is a process of its own each time, of 40 ms
            number = count // 4 if kind == "mol2" else count
            reads(f"dock: {kind}", f"m.{kind}", mutants(kind, texts(f"good.{kind}"), number), docked, Failed)
    try:
        from hapgrid.apps.molecule import reading
    except ImportError as why:
        return print(f"molecule: not installed: {why}")
    for kind in "sdf", "xyz", "mol2", "pdb", "cif":
        inputs = texts(f"{SOURCE}/tests/python/molecules/*.{kind}")
        reads(f"molecule: {kind}", f"m.{kind}", mutants(f"molecule {kind}", inputs, count), lambda path: reading.read(path, None), Failed)


{"filters": all_filters, "apps": all_apps}[part]()
for one in failures[:20]:
    print("FINDING:", one)
sys.exit(f"{len(failures)} findings; again with HAPGRID_MUTANTS_SEED={seed}" if failures else 0)
