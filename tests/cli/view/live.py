"""Drives the live page of hapgrid feel in Chromium.

usage: live.py mouse|finger|next ADDRESS
"""
import asyncio
import sys
import tempfile
import urllib.error
import urllib.request

import websockets
from browser import Browser


def status(address):
    try:
        with urllib.request.urlopen(address) as answer:
            return answer.status
    except urllib.error.HTTPError as e:
        return e.code


async def comes_in(address, origin):
    try:
        async with websockets.connect(address, subprotocols=["hapgrid"], origin=origin):
            return True
    except (websockets.exceptions.WebSocketException, OSError):
        return False


def strangers_are_refused(address):
    here = address.split("/")[2]
    wrong = f"http://{here}/{'0' * 32}/"
    assert status(wrong) == 403 and status(f"http://{here}/") == 403
    socket = address.replace("http:", "ws:") + "ws"
    assert not asyncio.run(comes_in(wrong.replace("http:", "ws:") + "ws", f"http://{here}"))
    assert not asyncio.run(comes_in(socket, "http://elsewhere.example"))
    assert not asyncio.run(comes_in(socket, None))


def line(from_x, to_x, y, steps):
    return [(from_x + (to_x - from_x) * i / steps, y) for i in range(steps + 1)]


def goes_to_the_next_level(browser, address):
    """Without WebGL, where the page has no picture. The HIP begins beside the ball, which can hang on either side of it."""
    page = browser.open(address)
    page.wait("hand && frames.length > 2")
    assert page.value("gl === null && element('say').textContent.includes('WebGL')")
    place = "Math.sign(frames[frames.length - 1].centres[0] - frames[frames.length - 1].hip[0])"
    for press in ("window.dispatchEvent(new KeyboardEvent('keydown', {key: 'n'}))", "element('next').click()"):
        side, snaps = page.value(f"[{place}, snaps]")
        page.value(press)
        page.wait(f"{place} === {-side} && snaps === {snaps + 1}")
        page.wait(f"element('status').textContent.includes('snaps {snaps + 1}')")
    assert not browser.complaints, browser.complaints
    page.close()


def main():
    how, address = sys.argv[1:]
    if how == "next":
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
            with Browser(folder, "--disable-gpu", "--disable-3d-apis") as browser:
                goes_to_the_next_level(browser, address)
        return
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder, Browser(folder) as browser:
        touch = how == "finger"
        width, height = (390, 844) if touch else (1000, 720)
        page = browser.open(address, width, height, touch)
        page.wait("hand && frames.length > 2")
        strangers_are_refused(address)
        watcher = browser.open(address, 600, 500)
        watcher.wait("frames.length > 2")
        page.to_front()
        # How many pixels the hand has to go: to x = -0.7 and then to 0.9.
        pixel = page.value("pixel()")
        x, y = width / 2, 200
        there = x - (page.value("hand[0]") + 0.7) / pixel
        back = there + 1.6 / pixel

        def push(start, end, steps):
            if touch:
                page.fingers([line(start, end, y, steps)])
            else:
                page.drag(line(start, end, y, steps))
        push(x, there, 8)
        page.wait("frames[frames.length - 1].hip[0] < -0.55")
        if touch:
            page.value("element('farther').dispatchEvent(new PointerEvent('pointerdown')),"
                       "element('farther').dispatchEvent(new PointerEvent('pointerup'))")
        else:
            page.wheel(x, y, -100)
        snapped = page.value("snaps")  # once, where the ball hung to the left of the HIP
        push(there, back, 20)
        page.wait(f"snaps === {snapped + 1} && frames[frames.length - 1].hip[0] > 0.6")
        watcher.wait(f"snaps === {snapped + 1} && frames[frames.length - 1].hip[0] > 0.6")
        # It sees the other's hand, and has none.
        assert watcher.value("hand") is None
        watcher.wait("Math.abs(frames[frames.length - 1].hand[0] - 0.9) < 0.05")
        # Two fingers, or the other button, turn the picture and leave the hand.
        before = page.value("[hand[0], view.axes[0][0], view.zoom]")
        if touch:
            page.fingers([line(100, 160, 300, 10), line(200, 320, 300, 10)])
            assert page.value("view.zoom") > 1.1 * before[2]
        else:
            page.drag(line(300, 350, 300, 10), button="right")
        assert page.value("view.axes[0][0]") != before[1] and page.value("hand[0]") == before[0]
        # The page keeps the last seconds alone.
        assert page.value("frames[frames.length - 1].time - frames[0].time") <= page.value("kLiveSeconds")
        assert not browser.complaints, browser.complaints
        page.close()  # ends the play
        watcher.wait("ended")


main()
