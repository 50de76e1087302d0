"""A headless Chromium driven over the DevTools protocol, and `etalon view` under way. Needs nothing but the standard library."""

import base64
import json
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SIZE = (1280, 780)


class WebSocket:
    """A client of RFC 6455, as far as DevTools needs one."""

    def __init__(self, address):
        host, path = re.fullmatch(r"ws://([^/]+)(/.*)", address).groups()
        name, port = host.rsplit(":", 1)
        self.socket = socket.create_connection((name, int(port)), timeout=60)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET {path} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            self.buffer += self.socket.recv(4096)
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0]:
            raise RuntimeError(head.decode())

    def send(self, text):
        data = text.encode()
        length = len(data)
        if length < 126:
            head = struct.pack("!BB", 0x81, 0x80 | length)
        elif length < 1 << 16:
            head = struct.pack("!BBH", 0x81, 0x80 | 126, length)
        else:
            head = struct.pack("!BBQ", 0x81, 0x80 | 127, length)
        # A mask of zeros leaves the data as they are.
        self.socket.sendall(head + bytes(4) + data)

    def _take(self, count):
        while len(self.buffer) < count:
            more = self.socket.recv(1 << 16)
            if not more:
                raise RuntimeError("the browser has gone")
            self.buffer += more
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def receive(self):
        whole = b""
        while True:
            first, second = self._take(2)
            length = second & 0x7F
            if length == 126:
                (length,) = struct.unpack("!H", self._take(2))
            elif length == 127:
                (length,) = struct.unpack("!Q", self._take(8))
            data = self._take(length)
            kind = first & 0x0F
            if kind in (0, 1, 2):
                whole += data
                if first & 0x80:
                    return whole.decode()
            elif kind == 8:
                raise RuntimeError("the browser closed the connection")


class Browser:
    """A headless Chromium."""

    def __init__(self):
        names = [os.environ.get("CHROMIUM", ""), "chromium", "chromium-browser", "google-chrome"]
        program = next((found for name in names if name and (found := shutil.which(name))), None)
        if program is None:
            sys.exit("there is no Chromium: install it, or name it by CHROMIUM")
        self.profile = tempfile.TemporaryDirectory()
        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--hide-scrollbars",
             f"--user-data-dir={self.profile.name}", f"--window-size={SIZE[0]},{SIZE[1]}", "about:blank"],
            stderr=subprocess.PIPE, text=True,
        )
        for line in self.process.stderr:
            if found := re.search(r"ws://([^/]+)/devtools", line):
                self.host = found.group(1)
                break
        # Nobody reads what follows, and the pipe must not fill.
        threading.Thread(target=lambda: [None for _ in self.process.stderr], daemon=True).start()

    def page(self, address):
        request = urllib.request.Request(f"http://{self.host}/json/new?about:blank", method="PUT")
        with urllib.request.urlopen(request) as answer:
            target = json.load(answer)
        return Page(self, target, address)

    def close(self):
        self.process.terminate()
        self.process.wait(timeout=20)
        self.profile.cleanup()


class Page:
    """A tab."""

    def __init__(self, browser, target, address):
        self.browser, self.target = browser, target
        self.socket = WebSocket(target["webSocketDebuggerUrl"])
        self.number = 0
        self.errors = []
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=SIZE[0], height=SIZE[1], deviceScaleFactor=1, mobile=False)
        self.call("Page.navigate", url=address)

    def call(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self.socket.receive())
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self._note(message)

    def _note(self, message):
        if message.get("method") == "Runtime.exceptionThrown":
            details = message["params"]["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        if message.get("method") == "Log.entryAdded" and message["params"]["entry"]["level"] == "error":
            entry = message["params"]["entry"]
            self.errors.append(f"{entry['text']} {entry.get('url', '')}")

    def run(self, script):
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"]["exception"].get("description", "?"))
        return result["result"].get("value")

    def wait(self, what, script, seconds=30):
        """Waits until a script gives something true, and returns it."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.run(script)
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"in {seconds} s, not seen: {what}")

    def log(self, what):
        return self.run(f"window.etalonLog ? window.etalonLog.filter(e => e.what === {json.dumps(what)}) : []")

    def text(self, name):
        return self.run(f"document.getElementById({json.dumps(name)}).innerText")

    def at(self, x, y):
        """Where a share of the picture's width and height is in the window."""
        box = self.run("(() => { const b = document.getElementById('picture').getBoundingClientRect();"
                       " return [b.left, b.top, b.width, b.height]; })()")
        return box[0] + x * box[2], box[1] + y * box[3]

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def move(self, x, y):
        self.mouse("mouseMoved", *self.at(x, y))

    def click(self, x, y):
        x, y = self.at(x, y)
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        self.mouse("mouseReleased", x, y, button="left", clickCount=1)

    def press(self, selector, while_down=lambda: None):
        """Presses the mouse button over an element, does something, and lets the button go at the same place."""
        self.run(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{ block: 'center' }})")
        x, y = self.run(f"(() => {{ const b = document.querySelector({json.dumps(selector)}).getBoundingClientRect();"
                        " return [b.left + b.width / 2, b.top + b.height / 2]; })()")
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        while_down()
        self.mouse("mouseReleased", x, y, button="left", clickCount=1)

    def focus(self, selector):
        self.run(f"document.querySelector({json.dumps(selector)}).focus()")

    def select(self, name, value):
        """Chooses an entry of a list, as a person does: choosing the one that is chosen already changes nothing."""
        self.run(f"(() => {{ const e = document.getElementById({json.dumps(name)}); if (e.value === {json.dumps(value)}) return;"
                 f" e.value = {json.dumps(value)}; e.dispatchEvent(new Event('change')); }})()")

    def drag(self, start, end, steps=8, after_step=lambda: time.sleep(0.04), **more):
        (x0, y0), (x1, y1) = self.at(*start), self.at(*end)
        self.mouse("mouseMoved", x0, y0)
        time.sleep(0.3)
        self.mouse("mousePressed", x0, y0, button="left", clickCount=1, **more)
        for i in range(1, steps + 1):
            t = i / steps
            self.mouse("mouseMoved", x0 + t * (x1 - x0), y0 + t * (y1 - y0), button="left", buttons=1, **more)
            after_step()
        self.mouse("mouseReleased", x1, y1, button="left", clickCount=1, **more)

    def key(self, key):
        code = {"Escape": 27, " ": 32}.get(key, 0)
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, windowsVirtualKeyCode=code, text=key if len(key) == 1 else "")
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, windowsVirtualKeyCode=code)

    def choose(self, selector):
        self.run(f"document.querySelector({json.dumps(selector)}).click()")

    def shot(self, folder, name):
        if folder is None:
            return
        data = self.call("Page.captureScreenshot", format="png")["data"]
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.png").write_bytes(base64.b64decode(data))

    def close(self):
        try:
            urllib.request.urlopen(f"http://{self.browser.host}/json/close/{self.target['id']}").read()
        except OSError:
            pass


class Viewer:
    """`etalon view` under way."""

    def __init__(self, program, *words):
        self.process = subprocess.Popen(
            [program, "view", *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self.address = self.process.stdout.readline().strip()
        if not self.address.startswith("http://"):
            raise RuntimeError(self.process.stderr.read())

    def get(self, path="", headers=(), data=None, method=None, address=None):
        """Status and body of a request."""
        request = urllib.request.Request((address or self.address) + path, data=data, headers=dict(headers), method=method)
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                return answer.status, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.read()

    def cpu_seconds(self):
        """Processor time of the whole program and of each thread that is still there, by name (Linux)."""
        tick = os.sysconf("SC_CLK_TCK")
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        times = {"all": (int(fields[11]) + int(fields[12])) / tick}
        for task in Path(f"/proc/{self.process.pid}/task").iterdir():
            try:
                text = (task / "stat").read_text()
            except OSError:
                continue
            name, fields = text[text.index("(") + 1:text.rindex(")")], text[text.rindex(")") + 2:].split()
            times[name] = times.get(name, 0) + (int(fields[11]) + int(fields[12])) / tick
        return times

    def close(self):
        self.process.kill()
        self.process.wait()
