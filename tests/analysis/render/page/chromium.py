# SPDX-License-Identifier: BSD-3-Clause
"""A headless Chromium, driven over the pipe of its DevTools protocol; nothing but Python needed."""

import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

PATIENCE = 240.0  # [s] for any one answer or event: a busy machine is no failure


def find():
    """The browser's program, or None."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    """One process; messages are JSON that a zero byte ends, in on 3 and out on 4."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="montecarta_chromium_",
                                                  ignore_cleanup_errors=True)
        ours, theirs = self._pipes()

        def arrange():
            os.dup2(theirs[0], 3)
            os.dup2(theirs[1], 4)

        sandbox = ["--no-sandbox"] if os.geteuid() == 0 else []
        self.process = subprocess.Popen(
            [find(), "--headless", "--remote-debugging-pipe", "--disable-gpu", "--no-first-run",
             "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
             f"--user-data-dir={self.folder.name}", *sandbox],
            preexec_fn=arrange, close_fds=False, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in theirs:
            os.close(end)
        self.output, self.input = ours
        self.unread, self.number, self.events = b"", 0, []

    @staticmethod
    def _pipes():
        """(read, write) for us and for the browser, numbered well above 3 and 4."""
        def high(end):
            copy = fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 20)
            os.close(end)
            return copy
        to_read, to_write = os.pipe(), os.pipe()
        return (high(to_read[0]), high(to_write[1])), (high(to_write[0]), high(to_read[1]))

    def call(self, method, session=None, **parameters):
        """Sends a command and returns its result; events that come meanwhile are kept."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.input, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + PATIENCE
        while True:
            answer = self.receive(deadline)
            if answer.get("id") != self.number:
                self.events.append(answer)
            elif "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']['message']}")
            else:
                return answer["result"]

    def receive(self, deadline):
        while b"\0" not in self.unread:
            ready, _, _ = select.select([self.output], [], [], max(deadline - time.monotonic(), 0))
            piece = os.read(self.output, 1 << 20) if ready else b""
            if not piece:
                raise RuntimeError("chromium: it does not answer")
            self.unread += piece
        text, self.unread = self.unread.split(b"\0", 1)
        return json.loads(text)

    def close(self):
        self.process.terminate()
        self.process.wait()
        os.close(self.input)
        os.close(self.output)
        self.folder.cleanup()


class Page:
    """A tab with a screen of its own."""

    def __init__(self, browser, width=1200, height=800, *, dark=False, touch=False, scripts=True):
        self.browser, self.scripts = browser, scripts
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=target,
                                    flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.call("Performance.enable", timeDomain="threadTicks")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=touch)
        self.call("Emulation.setTouchEmulationEnabled", enabled=touch)
        self.call("Emulation.setScriptExecutionDisabled", value=not scripts)
        self.call("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def open(self, path):
        """Loads a file, until it stands there."""
        self.browser.events = [event for event in self.browser.events
                               if event.get("sessionId") != self.session]
        self.call("Page.navigate", url="file://" + os.path.abspath(path))
        deadline = time.monotonic() + PATIENCE
        while not self.heard("Page.loadEventFired"):
            self.browser.events.append(self.browser.receive(deadline))
        if self.scripts:  # drawn, too
            self.evaluate("new Promise(done => requestAnimationFrame(() => setTimeout(done)))")

    def work(self):
        """Processor time [s] of the first page that the tab opened, which a machine that has other
        work to do does not make more."""
        metrics = self.call("Performance.getMetrics")["metrics"]
        return next(metric["value"] for metric in metrics if metric["name"] == "TaskDuration")

    def heard(self, method):
        return [event["params"] for event in self.browser.events
                if event.get("method") == method and event.get("sessionId") == self.session]

    def complaints_of_console(self):
        """All that a developer would see in red or yellow."""
        thrown = [str(event["exceptionDetails"]) for event in self.heard("Runtime.exceptionThrown")]
        said = [str(event["args"]) for event in self.heard("Runtime.consoleAPICalled")
                if event["type"] in ("error", "warning", "assert")]
        return thrown + said + [str(event["entry"]) for event in self.heard("Log.entryAdded")]

    def requested(self):
        return [event["request"]["url"] for event in self.heard("Network.requestWillBeSent")]

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                           awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def middle(self, selector, x=0.5, y=0.5):
        """A place within an element, in pixels of the window, where it is scrolled to."""
        return self.evaluate(f"""(() => {{
            const element = document.querySelector({json.dumps(selector)});
            element.scrollIntoView({{block: "center", behavior: "instant"}});
            const box = element.getBoundingClientRect();
            return [box.left + {x} * box.width, box.top + {y} * box.height];
        }})()""")

    def mouse(self, kind, place, **parameters):
        self.call("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], **parameters)

    def hover(self, place):
        self.mouse("mouseMoved", place)

    def click(self, place, count=1, modifiers=0):
        for number in range(1, count + 1):
            for kind in ("mousePressed", "mouseReleased"):
                self.mouse(kind, place, button="left", clickCount=number, modifiers=modifiers)

    def drag(self, begin, end):
        self.mouse("mousePressed", begin, button="left", clickCount=1)
        self.mouse("mouseMoved", end, button="left", buttons=1)
        self.mouse("mouseReleased", end, button="left", clickCount=1)

    def wheel(self, place, delta, modifiers=0):
        self.mouse("mouseWheel", place, deltaX=0, deltaY=delta, modifiers=modifiers)

    def touch(self, kind, places):
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[
            {"x": x, "y": y, "id": i} for i, (x, y) in enumerate(places)])

    def press(self, key, code=None):
        text = {"text": key} if len(key) == 1 else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, code=code or key, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, code=code or key)

    def screenshot(self, path, whole=False):
        image = self.call("Page.captureScreenshot", captureBeyondViewport=whole)
        with open(path, "wb") as file:
            file.write(base64.b64decode(image["data"]))
