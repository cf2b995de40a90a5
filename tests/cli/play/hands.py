"""Counts again, from their log, what bench_hands says of its sessions.

hands.py LOG TABLE REPORT SUMMARY, with the sim.toml of hands.sh
hands.py error LOG TRUTH TABLE     the errors of LOG's forces against those of the model in TRUTH

How the hand wanders and rests is in unit/device/simulated_test.cpp.
"""
import json
import math
import re
import sys

SCALE, TICKS = 19.0, 4000


def read(name):
    lines = [line.split("\t") for line in open(name).read().splitlines()]
    names = [n.removeprefix("# ") for n in lines[0]]
    return [dict(zip(names, map(float, line))) for line in lines[1:]]


def vector(row, names):
    return [row[n] for n in names]


SENT, MODEL = ("sent_x", "sent_y", "sent_z"), ("force_x", "force_y", "force_z")


def near(a, b, what, bound=1e-9):
    assert abs(a - b) <= bound * max(1, abs(b)), (what, a, b)


def judge(log, table, report, summary):
    rows, sessions = read(log), read(table)
    assert len(sessions) == 6 and len(rows) == 6 * TICKS
    for k, said in enumerate(sessions):
        ticks = rows[k * TICKS:(k + 1) * TICKS]
        sent = [[0, 0, 0]] + [vector(t, SENT) for t in ticks]  # in effect a tick late
        x = [[c / SCALE for c in vector(t, "xyz")] for t in ticks]
        given = highest = 0
        stored = 1000 * ticks[0]["energy"] / SCALE  # 1 N times a rope length
        for n in range(TICKS - 1):
            given += 1000 * sum(f * (b - a) for f, a, b in zip(sent[n], x[n], x[n + 1]))
            highest = max(highest, given - stored)
        near(said["stored_mJ"], stored, "stored")
        near(said["given_mJ"], given, "given")
        near(said["returned_mJ"], highest, "returned")
        near(said["largest_step_N"], max(math.dist(a, b) for a, b in zip(sent, sent[1:])), "step")
    assert sum(s["holds"] for s in sessions) > 3 and max(s["returned_mJ"] for s in sessions) > 0
    said = json.load(open(report))
    returned = [s["returned_mJ"] for s in sessions]
    near(said["returned_mJ"]["mean"], sum(returned) / 6, "mean")
    assert said["returned_mJ"]["worst"] == max(returned)
    assert said["returned_mJ"]["session"] == returned.index(max(returned))
    assert said["sessions"] == 6 and said["holds"] == sum(s["holds"] for s in sessions)
    assert said["ticks_in_contact"] == sum(s["contact_ticks"] for s in sessions)
    number = r"([-+.e0-9]+)"
    text = open(summary).read()
    found = re.search(rf"of 6 sessions: mean {number} mJ, worst {number} mJ in session (\d)\n", text)
    near(float(found[1]), sum(returned) / 6, "summary", 0.01)
    near(float(found[2]), max(returned), "summary", 0.01)


def compare(log, truth, table):
    played, model, sessions = read(log), read(truth), read(table)
    for k, said in enumerate(sessions):
        sent, raw = [], []
        for p, m in zip(played[k * TICKS:(k + 1) * TICKS], model[k * TICKS:(k + 1) * TICKS]):
            assert vector(p, "xyz") == vector(m, "xyz")
            right = vector(m, MODEL)
            if max(math.hypot(*right), math.hypot(*vector(p, MODEL))) < 0.01:
                continue
            sent.append(math.dist(vector(p, SENT), right))
            raw.append(math.dist(vector(p, MODEL), right))
        assert said["contact_ticks"] == len(sent), (said, len(sent))
        for name, errors in (("sent", sent), ("raw", raw)):
            if not errors:
                continue
            near(said[name + "_mean_N"], sum(errors) / len(errors), name)
            p99 = sorted(errors)[math.ceil(0.99 * len(errors)) - 1]
            # A bin of the histogram is 1/128 wide, or a nanonewton.
            assert p99 - 1e-9 <= said[name + "_p99_N"] <= p99 * (1 + 1 / 128) + 2e-9, (name, said, p99)
    assert sum(s["contact_ticks"] for s in sessions) > 100


if sys.argv[1] == "error":
    compare(*sys.argv[2:])
else:
    judge(*sys.argv[1:])
