# SPDX-License-Identifier: BSD-3-Clause
"""Headless Chromium, driven by the DevTools protocol over a pipe (messages end with a zero byte)."""
import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time


SIZE = (700, 500)  # of the window [pixels]: pictures are drawn without a graphics processor


def find_chromium():
    """None where it is not installed."""
    return shutil.which("chromium")


class PageError(Exception):
    """The page threw, or the browser refused."""


class Browser:
    """One browser with one page. Console errors and exceptions collect in `errors`."""

    def __init__(self):
        self.profile = tempfile.TemporaryDirectory(prefix="jink_viewer_", ignore_cleanup_errors=True)
        to_browser, from_browser = os.pipe(), os.pipe()

        def descriptors():
            """Chromium reads descriptor 3 and writes descriptor 4."""
            read_end, write_end = os.dup(to_browser[0]), os.dup(from_browser[1])
            os.dup2(read_end, 3)
            os.dup2(write_end, 4)

        self.process = subprocess.Popen(
            [find_chromium(), "--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run",
             "--disable-extensions", "--disable-background-networking", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--hide-scrollbars", f"--user-data-dir={self.profile.name}", "about:blank"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, close_fds=False, preexec_fn=descriptors)
        os.close(to_browser[0])
        os.close(from_browser[1])
        self.write_end, self.read_end = to_browser[1], from_browser[0]
        self.buffer, self.number, self.session, self.errors, self.requests = b"", 0, None, [], []
        targets = self.call("Target.getTargets")["targetInfos"]
        page = next(t for t in targets if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.resize(*SIZE)

    def pixels(self, replay, colours):
        """Pixels of a replay's canvas near each colour, and the number of different colours in it."""
        return self.run("""(() => {
          const replay = %s, source = replay.canvas, copy = document.createElement('canvas');
          copy.width = source.width; copy.height = source.height;
          const context = copy.getContext('2d', {willReadFrequently: true});
          replay.render();
          context.drawImage(source, 0, 0);
          const data = context.getImageData(0, 0, copy.width, copy.height).data, wanted = %s, found = {}, seen = new Set();
          for (const name in wanted) found[name] = 0;
          for (let i = 0; i < data.length; i += 4) {
            seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
            for (const name in wanted) {
              const [r, g, b] = wanted[name];
              if (Math.abs(r - data[i]) <= 6 && Math.abs(g - data[i + 1]) <= 6 && Math.abs(b - data[i + 2]) <= 6) ++found[name];
            }
          }
          return {found, different: seen.size};
        })()""" % (replay, json.dumps(colours)))

    def close(self):
        os.close(self.write_end)
        os.close(self.read_end)
        self.process.terminate()
        self.process.wait(timeout=20)
        self.profile.cleanup()

    def receive(self, timeout):
        until = time.monotonic() + timeout
        while b"\0" not in self.buffer:
            if not select.select([self.read_end], [], [], max(0.0, until - time.monotonic()))[0]:
                raise TimeoutError("the browser is silent")
            data = os.read(self.read_end, 1 << 20)
            if not data:
                raise PageError("the browser has ended")
            self.buffer += data
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def note(self, event):
        method, parameters = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in parameters["args"]))
        elif method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.errors.append(parameters["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])

    def call(self, method, timeout=60.0, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.write_end, data):]
        while True:
            answer = self.receive(timeout)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise PageError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.note(answer)

    def wait_for(self, method, timeout=60.0):
        while True:
            event = self.receive(timeout)
            self.note(event)
            if event.get("method") == method:
                return

    def resize(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def open(self, file):
        self.errors, self.requests = [], []
        self.call("Page.navigate", url=f"file://{file}")
        self.wait_for("Page.loadEventFired")

    def run(self, expression):
        """The value of an expression in the page; of a promise what it comes to."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise PageError(result["exceptionDetails"].get("exception", {}).get("description", expression))
        return result["result"].get("value")

    def press(self, key, shift=False):
        modifiers = 8 if shift else 0
        text = key if len(key) == 1 else ""
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, text=text, modifiers=modifiers)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, modifiers=modifiers)

    def click(self, selector):
        box = self.run(f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView({{block: 'center'}});"
                       " const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()")
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=box[0], y=box[1], button="left", buttons=1, clickCount=1)

    def picture(self, file):
        with open(file, "wb") as out:
            out.write(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))
