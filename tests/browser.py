"""A headless Chromium, driven over a pipe by the DevTools protocol; the standard library is enough for it."""
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from typing import Any

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--remote-debugging-pipe"]
PATIENCE_S = 120


def program() -> str | None:
    """The browser of this machine, or None."""
    return shutil.which("chromium") or shutil.which("chromium-headless-shell")


class Browser:
    """One browser process with one page, used as `with Browser() as browser:`."""

    def __enter__(self) -> "Browser":
        self.profile = tempfile.mkdtemp()
        to_browser, self.write = os.pipe()
        self.read, from_browser = os.pipe()

        def pipes() -> None:  # the protocol needs descriptors 3 and 4
            first, second = os.dup(to_browser), os.dup(from_browser)
            os.dup2(first, 3)
            os.dup2(second, 4)

        self.process = subprocess.Popen([program() or "chromium", *FLAGS, f"--user-data-dir={self.profile}", "about:blank"], preexec_fn=pipes,
                                        close_fds=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.last, self.buffer = 0, b""
        self.events: list[dict[str, Any]] = []
        self.session: str | None = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(domain + ".enable")
        return self

    def __exit__(self, *_: object) -> None:
        self.process.terminate()
        self.process.wait()
        os.close(self.write)
        os.close(self.read)
        shutil.rmtree(self.profile, ignore_errors=True)

    def message(self) -> dict[str, Any]:
        """The next message of the browser."""
        deadline = time.monotonic() + PATIENCE_S
        while b"\0" not in self.buffer:
            ready = select.select([self.read], [], [], max(0, deadline - time.monotonic()))[0]
            received = os.read(self.read, 1 << 20) if ready else b""
            if not received:
                raise RuntimeError("the browser is silent" if not ready else "the browser has ended")
            self.buffer += received
        text, self.buffer = self.buffer.split(b"\0", 1)
        answer: dict[str, Any] = json.loads(text)
        return answer

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """The reply to a command; events that arrive meanwhile are kept in self.events."""
        self.last += 1
        command: dict[str, Any] = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            command["sessionId"] = self.session
        os.write(self.write, json.dumps(command).encode() + b"\0")
        while (message := self.message()).get("id") != self.last:
            self.events.append(message)
        if "error" in message:
            raise RuntimeError(f"{method}: {message['error']['message']}")
        result: dict[str, Any] = message["result"]
        return result

    def open(self, address: str) -> None:
        """Goes to a page and waits until all of it is there."""
        self.events.clear()
        self.call("Page.navigate", url=address)
        while not any(event["method"] == "Page.loadEventFired" for event in self.events):
            self.events.append(self.message())

    def size(self, width: int, height: int = 900) -> None:
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def value(self, expression: str) -> Any:
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        return answer["result"].get("value")

    def complaints(self) -> list[str]:
        """Messages of the console since the page was opened: errors, warnings and exceptions."""
        out = []
        for event in self.events:
            parameters = event.get("params", {})
            if event["method"] == "Runtime.exceptionThrown":
                out.append(parameters["exceptionDetails"]["text"])
            elif event["method"] == "Log.entryAdded":
                out.append(parameters["entry"]["text"] + " " + parameters["entry"].get("url", ""))
            elif event["method"] == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
                out.append(str([value.get("value") for value in parameters["args"]]))
        return out
