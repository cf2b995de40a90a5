"""Feels a page that plays its grid by itself, from a file: pushes through the model until it snaps, and saves the path.

usage: feel.py PAGE WIDTH [bare]     narrower than 600 pixels, a finger pushes; else the mouse does; bare: without WebGL

The last line is what the page shows at the end, as JSON."""
import json
import os
import re
import sys
import tempfile
import time

from browser import Browser

file, width = sys.argv[1], int(sys.argv[2])
touch = width < 600
height = 844 if touch else 900


def push(page, way):
    if touch:
        page.fingers([way], step_s=0.03)
    else:
        page.drag(way, step_s=0.03)


def begins(browser):
    page = browser.open("file://" + file, width, height, touch)
    page.wait("hand && frames.length > 2")
    said = page.value("element('say').textContent")
    assert "Drag" in said and "hapgrid 0" in said and page.value("data.own.grid") in said, said
    assert page.value("document.documentElement.scrollWidth") <= width
    # It begins outside of the model, where there is no force.
    assert page.value("frames[0].size") <= 0.01 * page.value("data.full_force"), page.value("frames[0].size")
    return page


def names_atoms(page):
    """The pointer over the foremost atom has its name, as the torsions have them: the element and the number."""
    front = page.value("Math.max(...data.spheres.map((_, k) => dot(view.axes[2], sphere(frames[shown], k)) + data.spheres[k][0]))")
    number = page.value(f"data.spheres.findIndex((one, k) => dot(view.axes[2], sphere(frames[shown], k)) + one[0] === {front})")
    left, top, x, y = page.value(f"(r => [r.left, r.top, ...inPicture(sphere(frames[shown], {number}))])(element('scene').getBoundingClientRect())")
    page.mouse("mouseMoved", left + x, top + y)
    page.wait("pointed !== null")
    name = page.value("nameAt(frames[shown], pointed)")
    assert re.fullmatch(f"[A-Z][a-z]?{number + 1}", name), (name, number)
    torsion = page.value("data.own.torsions[0][2]")
    assert number >= 4 or name in torsion.split("-"), (name, torsion)  # of dichloroethane


def pushes_until_it_snaps(page):
    """To and fro along x, at the height of the middle, each time a little elsewhere."""
    middle = "data.low.map((x, a) => (x + data.high[a]) / 2)"
    left, top = page.value("(r => [r.left, r.top])(element('scene').getBoundingClientRect())")
    for turn in range(12):
        x, y = page.value("inPicture(hand)")
        to = page.value(f"inPicture([{'data.high' if turn % 2 == 0 else 'data.low'}[0], hand[1], {middle}[2]])")
        page.value(f"moveHand(0, 0, (hand[1] - {middle}[1] - {0.03 * turn} * (data.high[1] - data.low[1])))")
        push(page, [(left + x + (to[0] - x) * i / 40, top + y + (to[1] - y) * min(1, i / 5)) for i in range(41)])
        time.sleep(0.3)
        if page.value("snaps") > 0:
            return
    raise AssertionError("nothing snaps")


def saves(browser, page, folder):
    page.value("element('play').click()")  # time stops
    browser.ask("Browser.setDownloadBehavior", behavior="allow", downloadPath=folder)
    page.value("element('path').click()")
    deadline = time.monotonic() + 60
    while not os.path.exists(os.path.join(folder, "hapgrid-path.txt")):
        assert time.monotonic() < deadline, "no path"
        time.sleep(0.05)
    print(json.dumps(page.value("(f => ({hip: f.hip, force: f.force, snaps: f.jumps - 1, ticks: player.kept}))(frames[frames.length - 1])")))


def goes_to_the_next_level(browser):
    """In the middle, where the ball can hang on either side of the HIP."""
    page = browser.open("file://" + file, width, height)
    page.wait("hand && frames.length > 2")
    assert page.value("gl === null && element('say').textContent.includes('WebGL')")
    page.value("hand = [0, 0, 0], wake()")
    page.wait("Math.abs(frames[frames.length - 1].hip[0]) < 0.1")
    place = "Math.sign(frames[frames.length - 1].centres[0] - frames[frames.length - 1].hip[0])"
    for press in ("window.dispatchEvent(new KeyboardEvent('keydown', {key: 'n'}))", "element('next').click()"):
        side, snaps = page.value(f"[{place}, snaps]")
        page.value(press)
        page.wait(f"{place} === {-side} && snaps === {snaps + 1}")
        page.wait(f"element('status').textContent.includes('snaps {snaps + 1}')")
    assert not browser.complaints, browser.complaints


def stays_as_large(browser):
    """Ten minutes of play, as fast as the player goes: after them the page is as large as after five, and below 100 MB."""
    page = browser.open("file://" + file, width, height, touch)
    page.wait("hand && frames.length > 2")
    page.ask("Performance.enable")
    page.value("window.requestAnimationFrame = () => 0, player.last = undefined, from = [...hand], pictures = 0")

    def size():
        page.value("""for (let i = 0; i < 3000; ++i) {  // each of 100 ticks
          ++pictures, player.idle = 0;
          hand = from.map((x, a) => x + 0.4 * (data.high[a] - data.low[a]) * Math.sin(pictures / (20 + 7 * a)));
          playOn(100 * pictures);
        }""")
        page.ask("HeapProfiler.collectGarbage")
        numbers = {one["name"]: one["value"] for one in page.ask("Performance.getMetrics")["metrics"]}
        counters = page.ask("Memory.getDOMCounters")
        return numbers["JSHeapUsedSize"], counters["nodes"] + counters["jsEventListeners"], page.value("player.memory.buffer.byteLength")
    five, ten = size(), size()
    assert page.value("frames.at(-1).time") > 599, page.value("frames.at(-1).time")
    # 32 bytes a picture are less than any part of a frame; V8 compiles meanwhile.
    assert ten[0] - five[0] < 32 * 3000 and ten[1] - five[1] < 100 and ten[2] == five[2], (five, ten)
    path = 8 * 3 * page.value("kPathTicks")
    assert ten[0] + ten[2] + path < 100e6, (ten, path)
    print(f"ten minutes: {(ten[0] + ten[2] + path) / 1e6:.0f} MB, {ten[0] - five[0]:.0f} bytes more than after five")


if sys.argv[3:]:
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        with Browser(folder, "--disable-gpu", "--disable-3d-apis") as browser:
            goes_to_the_next_level(browser)
    sys.exit()
with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder, Browser(folder) as browser:
    began = time.monotonic()
    page = begins(browser)
    print(f"{time.monotonic() - began:.1f} s to the first pictures, memory {page.value('player.memory.buffer.byteLength') / 1e6:.0f} MB")
    if not touch and page.value("data.own.torsions.length"):
        names_atoms(page)
    pushes_until_it_snaps(page)
    # A hand that lets go comes to a place without force.
    page.value("element('letgo').click()")
    page.wait("!lettingGo && frames.at(-1).size <= 0.005 * data.full_force")
    # A hand at rest: time stops after a while, and goes on when the hand moves.
    page.wait("player.last === null")
    at_rest = page.value("frames[frames.length - 1].time")
    time.sleep(0.5)
    assert page.value("frames[frames.length - 1].time") == at_rest
    # Where pictures take long, one that moves has fewer pixels, and all of them when it rests.
    sharp = "gl.canvas.width / Math.round(window.devicePixelRatio * pictureSize()[0])"
    assert page.value(f"(() => {{ for (const t of [0, 0, 0]) {{ meanCost = lastCost = 1e4; drawn = null; draw(); }} return {sharp}; }})()") < 0.9
    page.wait(f"{sharp} === 1")
    # What is drawn is not drawn again, but for a picture that is saved.
    assert page.value("(draw(), isDrawn(frames[shown]))")
    assert page.value("""(() => {
      const kept = [], [before, context] = [download, gl];
      download = (_, address) => kept.push(address.length);
      for (gl of [context, null]) save();
      [download, gl] = [before, context];
      return kept[0] > 1.5 * kept[1];
    })()""")
    # Outside of the box, where no force acts, the thread says where the grid ends.
    page.value("texts = [], drawText = (c, text) => texts.push(text), hand = [data.hand_high[0], hand[1], data.high[2]], wake()")
    page.wait("frames[frames.length - 1].hip[0] === data.high[0] && frames[frames.length - 1].size === 0")
    page.wait("draw(), texts.at(-1) === 'edge of the grid'")
    # A torsion says its angle, and how high the barriers beside it are.
    for strip in page.value("data.own.torsions.map((one, k) => [frames.at(-1).angles[k], ...barriersBeside(one[3], frames.at(-1).angles[k])])"):
        assert -180 <= strip[0] <= 180 and min(strip[1:]) > 1, strip
    page.value("nextLevel()")
    page.wait(f"frames[frames.length - 1].time > {at_rest}")
    if not touch:
        stays_as_large(browser)
    saves(browser, page, os.getcwd())
    assert not browser.complaints, browser.complaints
    assert all(url.startswith(("file:", "data:", "blob:")) for url in browser.requests), browser.requests
