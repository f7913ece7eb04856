# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""What the numbered scenarios share: a daemon in a temporary folder, its messages, its control socket, its manager.

Times are generous bounds that only end a broken run, except where a scenario says otherwise.
"""
import contextlib
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import threading
import time

CAMLOCD = os.environ["CAMLOCD"]
LCM_TAP = os.environ["LCM_TAP"]
MAKE_SAMPLE_MAP = os.environ["MAKE_SAMPLE_MAP"]
PATIENCE_S = 30
SAMPLE = "sample://?width=320&height=240"


def wait_until(condition, what, patience_s=PATIENCE_S):
    """Returns the first true result of `condition`."""
    end = time.monotonic() + patience_s
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.02)
    raise AssertionError(f"not within {patience_s} s: {what}")


def add_route():
    subprocess.run(["ip", "route", "replace", "224.0.0.0/4", "dev", "lo"], check=True)


def make_map(path, num_frames=600):
    """A map of the sample room; another number of frames is another map. Replaces the file by a rename."""
    subprocess.run([MAKE_SAMPLE_MAP, str(path), str(num_frames)], check=True)


class Lines:
    """Collects the lines of a stream in the background."""

    def __init__(self, stream):
        self.lines = []
        self._thread = threading.Thread(target=self._read, args=(stream,), daemon=True)
        self._thread.start()

    def _read(self, stream):
        for line in stream:
            self.lines.append(line.rstrip("\n"))

    def join(self):
        self._thread.join(PATIENCE_S)

    def matching(self, pattern):
        return [line for line in list(self.lines) if re.search(pattern, line)]

    def wait_for(self, pattern, since=0):
        return wait_until(lambda: [line for line in list(self.lines)[since:] if re.search(pattern, line)], f"'{pattern}'")[0]


class Tap:
    """Listens on LCM."""

    def __init__(self):
        self._process = subprocess.Popen([LCM_TAP, "120"], stdout=subprocess.PIPE, text=True)
        self._lines = Lines(self._process.stdout)
        self._lines.wait_for("^ready")

    def messages(self, kind):
        """Dictionaries of the messages of that kind so far."""
        parsed = []
        for line in self._lines.matching(f"^{kind} "):
            words, _, text = line.partition(" text=")
            message = dict(word.split("=", 1) for word in words.split()[1:])
            message["text"] = text
            parsed.append(message)
        return parsed

    def wait_for(self, kind, condition, what):
        return wait_until(lambda: next((m for m in self.messages(kind) if condition(m)), None), what)

    def wait_for_new(self, kind, condition, what):
        """As wait_for, among the messages that are still to come."""
        seen = len(self.messages(kind))
        return wait_until(lambda: next((m for m in self.messages(kind)[seen:] if condition(m)), None), what)

    def close(self):
        self._process.kill()
        self._process.wait()


class Manager:
    """The service manager's end of the notification protocol."""

    def __init__(self, path):
        self.path = path
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(str(path))
        self._socket.settimeout(0.1)
        self.heard = []

    def listen(self):
        with contextlib.suppress(socket.timeout, BlockingIOError):
            while True:
                self.heard.append(self._socket.recv(4096).decode())

    def wait_for(self, text, since=0):
        def heard():
            self.listen()
            return any(text in message.split("\n") or message.startswith(text) for message in self.heard[since:])
        wait_until(heard, f"notification {text}")


class Daemon:
    """camlocd with settings given as section__key=value."""

    def __init__(self, folder, environment=None, stderr=subprocess.PIPE, shell="", **settings):
        self.folder = pathlib.Path(folder)
        self.socket = self.folder / "control.sock"
        self.config = self.folder / "camlocd.toml"
        if not self.config.exists():
            self.config.write_text("")
        values = {"control__socket": self.socket, "source__url": SAMPLE, "map__path": self.folder / "map.cmap",
                  "source__retry_ms": 100, **settings}
        command = [CAMLOCD, "--config", str(self.config)]
        for key, value in values.items():
            command += ["--set", f"{key.replace('__', '.')}={value}"]
        if shell:  # what is set before the daemon runs
            command = ["sh", "-c", shell + '; exec "$@"', "sh", *command]
        self.process = subprocess.Popen(command, stderr=stderr, text=True, env={**os.environ, **(environment or {})})
        self.log = Lines(self.process.stderr or [])

    def wait_started(self):
        self.log.wait_for("started")
        return self

    def ask(self, request, patience_s=PATIENCE_S):
        """One request over the control socket, the reply's text."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
            client.settimeout(patience_s)
            client.connect(str(self.socket))
            client.sendall(request if isinstance(request, bytes) else request.encode() + b"\n")
            chunks = []
            while chunk := client.recv(65536):
                chunks.append(chunk)
        return b"".join(chunks).decode()

    def command(self, request):
        return json.loads(self.ask(request))

    def wait_state(self, state):
        return wait_until(lambda: (status := self.command("status"))["state"] == state and status, f"state {state}")

    def signal(self, number):
        self.process.send_signal(number)

    def wait(self):
        code = self.process.wait(PATIENCE_S)
        self.log.join()
        return code

    def stop(self):
        self.signal(signal.SIGTERM)
        return self.wait()

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


@contextlib.contextmanager
def scenario():
    """Gives (folder, start, tap): `start` makes daemons that end with the scenario."""
    with tempfile.TemporaryDirectory(prefix="camloc_") as folder, contextlib.ExitStack() as stack:
        daemons = []

        def closing(thing):
            stack.callback(thing.close)
            return thing

        def start(**settings):
            daemons.append(closing(Daemon(folder, **settings)))
            return daemons[-1]

        def tap():
            return closing(Tap())

        try:
            yield pathlib.Path(folder), start, tap
        except BaseException:
            for daemon in daemons:
                print("--- log of camlocd:", *daemon.log.lines, sep="\n")
            raise
    print("passed")
