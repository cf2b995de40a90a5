"""Chromium without a screen, driven through its devtools protocol: pages, mouse, fingers and pictures."""
import base64
import json
import os
import select
import subprocess
import sys
import time

PATIENCE_S = 180  # Chromium takes a minute to start on a busy machine


class Browser:
    """One process; `with Browser(folder) as browser`. `options` are more of Chromium's arguments."""

    def __init__(self, folder, *options):
        commands, ours = os.pipe()
        answers, theirs = os.pipe()
        # Chromium talks through the descriptors 3 and 4.
        for end in commands, theirs:
            os.set_inheritable(end, True)
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{commands} 4>&{theirs}', "bash", "chromium", "--headless", "--no-sandbox",
             "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe",
             f"--user-data-dir={folder}", *options],
            pass_fds=(commands, theirs), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(commands)
        os.close(theirs)
        self.commands = os.fdopen(ours, "wb", buffering=0)
        self.answers = os.fdopen(answers, "rb", buffering=0)
        self.pending = b""
        self.number = 0
        self.complaints = []
        self.requests = []  # addresses

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.commands.close()
        self.process.kill()
        self.process.wait()

    def read(self):
        while b"\0" not in self.pending:
            if not select.select([self.answers], [], [], PATIENCE_S)[0]:
                sys.exit("Chromium hangs")  # as it sometimes does on a busy machine: in_time() knows these words
            more = self.answers.read(1 << 20)
            assert more, "Chromium has ended"
            self.pending += more
        message, self.pending = self.pending.split(b"\0", 1)
        return json.loads(message)

    def ask(self, method, session=None, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if session:
            request["sessionId"] = session
        self.commands.write(json.dumps(request).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("method") in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled"):
                self.complaints.append(answer["params"])
            if answer.get("method") == "Network.requestWillBeSent":
                self.requests.append(answer["params"]["request"]["url"])
            if answer.get("id") == self.number:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]

    def open(self, address, width=1000, height=720, touch=False, scale=1):
        return Page(self, address, width, height, touch, scale)


class Page:
    def __init__(self, browser, address, width, height, touch, scale):
        self.browser = browser
        self.target = browser.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.ask("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        self.ask("Runtime.enable")
        self.ask("Page.enable")
        self.ask("Network.enable")
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale,
                 mobile=touch)
        if touch:
            self.ask("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        self.ask("Page.navigate", url=address)

    def ask(self, method, **parameters):
        return self.browser.ask(method, self.session, **parameters)

    def to_front(self):
        """A page that another one hides draws nothing and takes no mouse."""
        self.ask("Page.bringToFront")

    def close(self):
        self.browser.ask("Target.closeTarget", targetId=self.target)

    def value(self, expression):
        result = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in result, result
        return result["result"].get("value")

    def wait(self, expression):
        """Waits until the expression is true, and returns its value."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            result = self.ask("Runtime.evaluate", expression=expression, returnByValue=True)
            value = result["result"].get("value")
            if "exceptionDetails" not in result and value:
                return value
            assert time.monotonic() < deadline, ("never", expression, result)
            time.sleep(0.02)

    def mouse(self, what, x, y, **more):
        self.ask("Input.dispatchMouseEvent", type=what, x=x, y=y, **more)

    def drag(self, way, button="left", step_s=0.02):
        """The mouse along the places `way`, with a button held."""
        buttons = {"left": 1, "right": 2}[button]
        self.mouse("mousePressed", *way[0], button=button, buttons=buttons, clickCount=1)
        for x, y in way[1:]:
            self.mouse("mouseMoved", x, y, button=button, buttons=buttons)
            time.sleep(step_s)
        self.mouse("mouseReleased", *way[-1], button=button, buttons=0, clickCount=1)

    def wheel(self, x, y, down):
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=down)

    def fingers(self, ways, step_s=0.02):
        """Fingers along places: each way is a list of places, all of one length."""
        for i, places in enumerate(zip(*ways)):
            self.ask("Input.dispatchTouchEvent", type="touchMove" if i else "touchStart",
                     touchPoints=[{"x": x, "y": y, "id": n} for n, (x, y) in enumerate(places)])
            time.sleep(step_s)
        self.ask("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def picture(self, name):
        with open(name, "wb") as file:
            file.write(base64.b64decode(self.ask("Page.captureScreenshot")["data"]))
