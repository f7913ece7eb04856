# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""A Kinect that is not there, for scenarios: starts tests/fakes/fake-kinect, steers it, and reads what it did and sent.

    with FakeKinect(folder, "--folder", kitchen, "--fault", "loss=0.001") as kinect:
        client = subprocess.Popen([...], env=kinect.environment)
        kinect.unplug(); kinect.replug(); kinect.stall("depth", 500); kinect.fault("loss=0.1")
        print(kinect.counts()["video"]["frames"], kinect.frames("depth")[-1].stamp_ticks)

Any number of clients may be started with `environment`, one after another or side by side as the device allows, and be killed. A
client's memory is read by the fake: it must be the same user's, and kernel.yama.ptrace_scope 0 unless the caller is root (also of
its own user namespace).
"""
import collections
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile

SKIPPED = 77
PATIENCE_S = 30

SentFrame = collections.namedtuple("SentFrame", "stream index stamp_ticks monotonic_ns format damaged hash")


def require():
    """Ends the scenario as skipped where the fake was not built."""
    if "FAKE_KINECT" not in os.environ or shutil.which("umockdev-wrapper") is None:
        print("skipped: no fake-kinect, as umockdev or libumockdev-dev is not installed")
        sys.exit(SKIPPED)


class FakeKinect:
    """Plugged in when the constructor returns (with --unplugged: not yet)."""

    def __init__(self, folder, *options):
        folder = pathlib.Path(folder)
        # The name of a UNIX socket is short, that of a scenario's folder need not be.
        self._socket_folder = tempfile.mkdtemp(prefix="kinect_")
        self._socket_path = os.path.join(self._socket_folder, "control")
        self.log_path = folder / "kinect.log"
        self.counts_path = folder / "kinect.counts"
        command = ["umockdev-wrapper", os.environ["FAKE_KINECT"], "--control", self._socket_path, "--log", str(self.log_path),
                   "--counts", str(self.counts_path), *map(str, options)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        if not line.startswith("UMOCKDEV_DIR="):
            raise AssertionError(f"fake-kinect did not start: {line!r}, code {self.process.wait(PATIENCE_S)}")
        self.environment = {**os.environ, "UMOCKDEV_DIR": line.strip().partition("=")[2], "LD_PRELOAD": "libumockdev-preload.so.0"}
        sanitizer = os.environ.get("ASAN_OPTIONS", "")
        self.environment["ASAN_OPTIONS"] = (sanitizer + ":" if sanitizer else "") + "verify_asan_link_order=0"

    def command(self, line):
        """The answer to a command of the control socket; an error is raised."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
            client.settimeout(PATIENCE_S)
            client.connect(self._socket_path)
            client.sendall(line.encode() + b"\n")
            answer = b""
            while not answer.endswith(b"\n"):
                received = client.recv(65536)
                if not received:
                    break
                answer += received
        text = answer.decode().strip()
        if text.startswith("error") or not text:
            raise AssertionError(f"fake-kinect, '{line}': {text or 'no answer'}")
        return text

    def unplug(self):
        self.command("unplug")

    def replug(self):
        self.command("replug")

    def stall(self, stream="both", how_long="forever"):
        """`stream` video, depth or both; `how_long` milliseconds or "forever"."""
        self.command(f"stall {stream} {how_long}")

    def resume(self):
        self.command("resume")

    def fault(self, spec):
        """KIND=PROBABILITY from now on, or KIND:TIMES."""
        self.command(f"fault {spec}")

    def counts(self):
        """What the fake did so far; after close() what it had done at the end."""
        if self.process.poll() is not None:
            return json.loads(self.counts_path.read_text())
        return json.loads(self.command("counts"))

    def frames(self, stream=None):
        """The frames sent so far, whole lines of the log only."""
        lines = self.log_path.read_text().split("\n")[:-1]
        sent = []
        for line in lines:
            name, index, stamp, monotonic, pixel_format, damaged, digest = line.split()
            if stream in (None, name):
                sent.append(SentFrame(name, int(index), int(stamp), int(monotonic), pixel_format, damaged == "1", digest))
        return sent

    def close(self):
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        shutil.rmtree(self._socket_folder, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
