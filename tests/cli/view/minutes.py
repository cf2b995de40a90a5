"""A live page is as large after ten minutes as after five. They take some seconds: a server sends the frames of a page of
view --html to the live page, which is the same without them, as fast as it draws.

usage: minutes.py PAGE.html
"""
import asyncio
import http
import json
import re
import sys
import tempfile
import threading

import websockets
from browser import Browser

PER_SECOND = 60
MINUTES = 10
HALF = 30 * MINUTES * PER_SECOND  # frames
FRAMES_A_PICTURE = 300  # at most: so at least 60 pictures are drawn in each half
SNAP_EVERY = PER_SECOND // 2  # frames
# Bytes that a page may keep of each frame, which is 2 kB large. Measured: 3 where it keeps nothing, since V8 compiles
# meanwhile; 38 where it keeps the text of each frame's time alone.
LEAST_KEPT = 32
# Chromium draws as fast as it can, where the screen of a browser without one stands still on a busy machine.
OPTIONS = "--disable-frame-rate-limit", "--disable-gpu-vsync"
# Draws 20 times a second, and counts the pictures, and all buffers, textures ... that the page makes for them.
COUNT = """
  window.made = 0, window.pictures = 0;
  for (const name in WebGL2RenderingContext.prototype) {
    if (!name.startsWith("create")) continue;
    const make = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...all) { ++made; return make.apply(this, all); };
  }
  window.requestAnimationFrame = (draw) => setTimeout(() => { draw(0); ++pictures; socket.send("picture"); }, 50);
"""


class Player:
    """Serves the page and, each time that it is told to go on, half of the minutes."""

    def __init__(self, page):
        scene, frames = re.search(r"\nlet data = (.*?);\nconst recorded = \[(.*?)\];\n", page, re.DOTALL).groups()
        self.page = page.replace(scene, "null").replace(frames, "").encode()
        self.scene, self.frames = json.loads(scene), json.loads(f"[{frames}]")
        self.go = threading.Semaphore(0)
        self.port = None
        started = threading.Event()
        threading.Thread(target=lambda: asyncio.run(self.serve(started)), daemon=True).start()
        assert started.wait(60)

    async def serve(self, started):
        async def page(path, _):
            if not path.endswith("/ws"):
                return http.HTTPStatus.OK, [("content-type", "text/html; charset=utf-8")], self.page

        async with websockets.serve(self.play, "127.0.0.1", 0, subprotocols=["hapgrid"], process_request=page,
                                    compression=None) as server:
            self.port = server.sockets[0].getsockname()[1]
            started.set()
            await asyncio.Future()

    async def play(self, socket):
        await socket.send(json.dumps({"scene": self.scene}))
        for i in range(2 * HALF):
            if i % HALF == 0:
                await asyncio.get_running_loop().run_in_executor(None, self.go.acquire)
            frame = self.frames[i % len(self.frames)]
            await socket.send(json.dumps({"frame": {**frame, "time": i / PER_SECOND, "jumps": i // SNAP_EVERY}}))
            if (i + 1) % FRAMES_A_PICTURE:
                continue
            for _ in range(FRAMES_A_PICTURE):  # what is confirmed
                while await socket.recv() != ".\n":
                    pass
            while await socket.recv() != "picture":
                pass
        async for _ in socket:
            pass


def size(page):
    """Of the page without its garbage: bytes; nodes and listeners; what was made for WebGL; and how many pictures it drew."""
    page.ask("HeapProfiler.collectGarbage")
    numbers = {one["name"]: one["value"] for one in page.ask("Performance.getMetrics")["metrics"]}
    counters = page.ask("Memory.getDOMCounters")
    return numbers["JSHeapUsedSize"], counters["nodes"] + counters["jsEventListeners"], page.value("made"), page.value("pictures")


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        player = Player(file.read())
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder, Browser(folder, *OPTIONS) as browser:
        page = browser.open("about:blank", 300, 450)
        page.ask("Page.addScriptToEvaluateOnNewDocument", source=COUNT)
        page.ask("Performance.enable")
        page.ask("Page.navigate", url=f"http://127.0.0.1:{player.port}/")
        sizes = []
        for half in 1, 2:
            player.go.release()
            page.wait(f"data && snaps === {half * HALF // SNAP_EVERY - 1} && frames[frames.length - 1].jumps === snaps && "
                      f"Math.round({PER_SECOND} * frames[frames.length - 1].time) === {half * HALF - 1} && !due")
            sizes.append(size(page))
        assert not browser.complaints, browser.complaints
    (heap, nodes, made, pictures), later = sizes
    assert later[3] - pictures >= HALF // FRAMES_A_PICTURE, sizes
    assert later[0] - heap < LEAST_KEPT * HALF, sizes
    assert later[1] - nodes < HALF / SNAP_EVERY / 2, sizes  # a node every other snap
    assert later[2] == made, sizes


main()
