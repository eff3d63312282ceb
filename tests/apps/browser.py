"""A headless Chromium that tests can ask about pages: what they request, say, and show."""
import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

PROGRAM = next((found for name in ("chromium", "chromium-browser", "google-chrome")
                if (found := shutil.which(name))), None)

# Every text against what lies behind it, WCAG 2's ratio; those below 4.5.
FAINT = """(() => {
  const parts = c => (c.match(/[\\d.]+/g) || []).map(Number);
  const light = ([r, g, b]) => [r, g, b].map(v => v / 255).map(
    v => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = e => { for (; e; e = e.parentElement) {
    const c = parts(getComputedStyle(e).backgroundColor);
    if (c.length === 3 || c[3] > 0) return c; } return [255, 255, 255]; };
  const faint = new Set();
  document.querySelectorAll('body *').forEach(e => {
    if (!Array.from(e.childNodes).some(n => n.nodeType === 3 && n.data.trim())) return;
    if (['SCRIPT', 'STYLE'].includes(e.tagName)) return;
    const svg = e.namespaceURI.endsWith('svg');
    const a = light(parts(getComputedStyle(e)[svg ? 'fill' : 'color']));
    const b = light(svg ? [255, 255, 255] : behind(e));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) faint.add(e.tagName + ' ' + e.className + ' ' + ratio.toFixed(2));
  });
  return Array.from(faint); })()"""
# Names that would like to be more than text.
HOSTILE = ["<script>alert(1)</script>", "\"><img src=x onerror=alert(2)>", "</script><b>bold",
           "\u202eright to left \u05e9\u05dc\u05d5\u05dd", "\U0001f6e2 drill", "long " * 2000,
           "a & b 'quoted'", "-->", "]]>"]


class Browser:
    """Chromium behind its DevTools pipe, without a network but this machine's loopback."""

    def __init__(self):
        self.profile = tempfile.mkdtemp()
        to_browser, self.write = os.pipe()
        self.read, from_browser = os.pipe()
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{to_browser} 4>&{from_browser}', "_", PROGRAM,
             "--headless", "--disable-gpu", "--no-first-run", "--no-sandbox",
             "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--remote-debugging-pipe",
             f"--user-data-dir={self.profile}", "about:blank"],
            pass_fds=(to_browser, from_browser), stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.last = b"", 0

    def Close(self):
        self.process.kill()
        self.process.wait()
        os.close(self.write)
        os.close(self.read)
        shutil.rmtree(self.profile, ignore_errors=True)

    def Message(self, timeout=30.0):
        """The next message, nothing when none comes in time."""
        end = time.monotonic() + timeout
        while b"\0" not in self.buffer:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.read], [], [], left)[0]:
                return None
            part = os.read(self.read, 1 << 20)
            if not part:
                raise RuntimeError("Chromium has ended")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def Send(self, method, parameters, session=None):
        self.last += 1
        message = {"id": self.last, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.write, json.dumps(message).encode() + b"\0")
        return self.last


class Page:
    """One page: `requests` beyond the page itself, `errors` of console, scripts and log. Only where
    it is `online` it reaches this machine's loopback."""

    def __init__(self, browser, *, width=1280, height=900, scripts=True, online=False):
        self.browser, self.requests, self.errors, self.events = browser, [], [], []
        self.session = None
        target = self.Do("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.Do("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Network", "Runtime", "Log"):
            self.Do(domain + ".enable")
        self.Do("Network.emulateNetworkConditions", offline=not online, latency=0,
                downloadThroughput=-1, uploadThroughput=-1)
        self.Do("Emulation.setDeviceMetricsOverride", width=width, height=height,
                deviceScaleFactor=1, mobile=False)
        self.Do("Emulation.setScriptExecutionDisabled", value=not scripts)

    def Do(self, method, **parameters):
        number = self.browser.Send(method, parameters, self.session)
        while True:
            message = self.browser.Message()
            if message is None:
                raise RuntimeError(method + ": no answer")
            if message.get("id") == number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.Hear(message)

    def Hear(self, message):
        method, said = message.get("method"), message.get("params", {})
        self.events.append(method)
        if method == "Network.requestWillBeSent":
            self.requests.append(said["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            self.errors.append(str(said["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and said["type"] in ("error", "assert"):
            self.errors.append(str(said["args"]))
        elif method == "Log.entryAdded" and said["entry"]["level"] in ("error", "warning"):
            self.errors.append(said["entry"]["text"])

    def Open(self, path, timeout=30.0):
        """Opens a file or an address and waits until it is loaded; what it requests beside itself
        is kept."""
        url = path if "://" in path else "file://" + path
        self.Do("Page.navigate", url=url)
        end = time.monotonic() + timeout
        while "Page.loadEventFired" not in self.events:
            message = self.browser.Message(end - time.monotonic())
            if message is None:
                raise RuntimeError(url + " did not load")
            self.Hear(message)
        self.Do("Runtime.evaluate", expression="1")
        self.requests = [r for r in self.requests if r != url and not r.startswith("data:")]

    def Until(self, expression, timeout=20.0):
        """Seconds until `expression` holds; an error where it does not in time."""
        begin = time.monotonic()
        while not self.Ask(expression):
            if time.monotonic() - begin > timeout:
                raise RuntimeError(f"{expression}: not within {timeout:g} s")
            time.sleep(0.05)
        return time.monotonic() - begin

    def Picture(self, path, whole=True):
        """The page as a picture, for people to look at."""
        data = self.Do("Page.captureScreenshot", format="png", captureBeyondViewport=whole)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))

    def Ask(self, expression):
        answer = self.Do("Runtime.evaluate", expression=expression, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(str(answer["exceptionDetails"]))
        return answer["result"].get("value")
