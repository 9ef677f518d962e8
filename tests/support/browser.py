"""A page in headless Chromium, driven over the pipe of its debugging protocol: real mouse, real keys, pictures."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FLAGS = (
    "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-sandbox",
    "--disable-extensions", "--disable-background-networking", "--no-first-run", "--hide-scrollbars",
    "--remote-debugging-pipe",
)  # fmt: skip

LEFT = ("Inspected target navigated or closed", "Cannot find context", "Execution context was destroyed")
"""What the browser answers where a page left while it was asked."""

START = """
import os, sys, fcntl
high = [fcntl.fcntl(int(fd), fcntl.F_DUPFD, 64) for fd in sys.argv[1:3]]
for fd, place in zip(high, (3, 4)):
    os.dup2(fd, place)
os.execvp(sys.argv[3], sys.argv[3:])
"""
"""The protocol is spoken on descriptors 3 and 4."""


def program() -> str | None:
    """The browser, or None where there is none."""
    return next(
        (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
    )


class Browser:
    """One page. Everything that the page's console says is in `said`."""

    def __init__(self, width: int = 1280, height: int = 900):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self.out = os.pipe()
        self.back, from_browser = os.pipe()
        command = [str(program()), *FLAGS, f"--user-data-dir={self.profile.name}", f"--window-size={width},{height}"]
        self.process = subprocess.Popen(
            [sys.executable, "-c", START, str(to_browser), str(from_browser), *command],
            pass_fds=(to_browser, from_browser), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(to_browser)
        os.close(from_browser)
        self.number, self.buffer, self.said, self.session = 0, b"", [], None
        self.loaded = 0.0
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.ask(f"{domain}.enable")
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.size = (width, height)

    def close(self) -> None:
        """End the browser."""
        try:
            self.ask("Browser.close", whole=True)
            self.process.wait(10)
        except (OSError, TimeoutError, RuntimeError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.out)
        os.close(self.back)
        self.profile.cleanup()

    def ask(self, method: str, whole: bool = False, **parameters: object) -> dict:
        """Ask the browser something, and wait for the answer."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session and not whole:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            heard = self.hear(60.0)
            if heard.get("id") == self.number:
                if "error" in heard:
                    raise RuntimeError(f"{method}: {heard['error']}")
                return heard["result"]

    def hear(self, patience: float) -> dict:
        """The next message; what the console says is kept."""
        end = time.monotonic() + patience
        while b"\0" not in self.buffer:
            if not select.select([self.back], [], [], max(0.0, end - time.monotonic()))[0]:
                raise TimeoutError("the browser says nothing")
            got = os.read(self.back, 1 << 20)
            if not got:
                raise OSError("the browser has gone")
            self.buffer += got
        text, _, self.buffer = self.buffer.partition(b"\0")
        message = json.loads(text)
        kind, about = message.get("method"), message.get("params", {})
        if kind == "Runtime.consoleAPICalled":
            values = " ".join(str(a.get("value", a.get("description"))) for a in about["args"])
            self.said.append(f"{about['type']}: {values}")
        elif kind == "Runtime.exceptionThrown":
            self.said.append(f"exception: {about['exceptionDetails']}")
        elif kind == "Log.entryAdded":
            self.said.append(f"{about['entry']['level']}: {about['entry']['text']}")
        return message

    def open(self, path: Path) -> None:
        """Open a file and wait until its viewer has started, or said that it cannot."""
        start = time.monotonic()
        self.ask("Page.navigate", url=path.resolve().as_uri())
        self.until("document.body && document.body.dataset.viewer && document.body.dataset.viewer !== 'starting'")
        self.loaded = time.monotonic() - start

    def run(self, expression: str) -> object:
        """The value of an expression of JavaScript; promises are waited for."""
        got = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in got:
            raise RuntimeError(got["exceptionDetails"])
        return got["result"].get("value")

    def until(self, expression: str, patience: float = 30.0) -> None:
        """Wait until the expression is true; a page that loads itself again meanwhile has not answered yet."""
        end = time.monotonic() + patience
        while not self.holds(expression):
            if time.monotonic() > end:
                raise TimeoutError(expression)
            time.sleep(0.05)

    def holds(self, expression: str) -> bool:
        """Whether the expression is true; false where the page left while it was asked."""
        try:
            return bool(self.run(f"Boolean({expression})"))
        except RuntimeError as error:
            if any(text in str(error) for text in LEFT):
                return False
            raise

    def settle(self) -> None:
        """Wait for the next two frames."""
        self.run("new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(() => go(1))))")

    def mouse(self, kind: str, x: float, y: float, **more: object) -> None:
        """One event of the mouse, in pixels of the window."""
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, x: float, y: float) -> None:
        """Press and release."""
        self.mouse("mouseMoved", x, y)
        for kind in ("mousePressed", "mouseReleased"):
            self.mouse(kind, x, y, button="left", buttons=1, clickCount=1)
        self.settle()

    def drag(self, x: float, y: float, to_x: float, to_y: float) -> None:
        """Press, move, release."""
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        for share in (0.3, 0.7, 1.0):
            self.mouse("mouseMoved", x + share * (to_x - x), y + share * (to_y - y), button="left", buttons=1)
        self.mouse("mouseReleased", to_x, to_y, button="left", clickCount=1)
        self.settle()

    def key(self, key: str) -> None:
        """Press and release a key."""
        text = {"text": key} if len(key) == 1 else {}
        self.ask("Input.dispatchKeyEvent", type="keyDown", key=key, **text)
        self.ask("Input.dispatchKeyEvent", type="keyUp", key=key)
        self.settle()

    def dark(self, dark: bool) -> None:
        """Prefer dark, or light, colours."""
        value = "dark" if dark else "light"
        self.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": value}])
        self.settle()

    def resize(self, width: int, height: int) -> None:
        """Another size of the window."""
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.size = (width, height)
        self.settle()

    def picture(self, path: Path, whole: bool = False) -> None:
        """The window, or the whole page, as PNG."""
        got = self.ask("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(got["data"]))
