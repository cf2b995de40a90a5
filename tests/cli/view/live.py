"""Watches the live page of view in Chromium, and ends the play.

usage: live.py ADDRESS PID     of the play
"""
import asyncio
import os
import signal
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


async def comes_in(address, origin, **headers):
    try:
        async with websockets.connect(address, subprotocols=["hapgrid"], origin=origin, extra_headers=headers):
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
    # Behind a proxy that speaks https, with the browser's name for it or with another one.
    assert asyncio.run(comes_in(socket, f"https://{here}"))
    assert asyncio.run(comes_in(socket, "https://hub.example", **{"X-Forwarded-Host": "hub.example"}))
    assert not asyncio.run(comes_in(socket, "https://elsewhere.example", **{"X-Forwarded-Host": "hub.example"}))


def moves_nothing(address):
    """A page that sends anything but a confirmation is sent away."""
    async def sends():
        async with websockets.connect(address.replace("http:", "ws:") + "ws", subprotocols=["hapgrid"],
                                      origin="http://" + address.split("/")[2]) as socket:
            await socket.send("0.1 0 0\n")
            try:
                while True:
                    await asyncio.wait_for(socket.recv(), 60)
            except websockets.exceptions.ConnectionClosed:
                return
    asyncio.run(sends())


def main():
    address, play = sys.argv[1], int(sys.argv[2])
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder, Browser(folder) as browser:
        pages = [browser.open(address, *size) for size in ((1000, 720), (390, 844))]
        strangers_are_refused(address)
        moves_nothing(address)
        for page in pages:
            page.to_front()
            page.wait("frames.length > 2")
            assert page.value("hand") is None and page.value("element('next').hidden && element('path').hidden")
            snapped = page.value("snaps")
            page.wait(f"snaps > {snapped}")
            page.wait("frames[frames.length - 1].hip[0] > 0.6")
            # A drag turns the picture, and the page keeps the last seconds alone.
            before = page.value("view.axes[0][0]")
            page.drag([(300 + 5 * i, 300) for i in range(10)])
            assert page.value("view.axes[0][0]") != before
            assert page.value("frames[frames.length - 1].time - frames[0].time") <= page.value("kLiveSeconds")
        # A connection that is lost is said, and is there again by itself.
        page.value("socket.close()")
        page.wait("element('scene').className === 'lost' && element('say').textContent.startsWith('The connection is lost')")
        page.wait("socket.readyState === 1 && element('scene').className === ''")
        last = page.value("frames[frames.length - 1].time")
        page.wait(f"frames[frames.length - 1].time > {last}")
        os.kill(play, signal.SIGTERM)
        for page in pages:
            page.wait("ended")
        assert not browser.complaints, browser.complaints


main()
