#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the virtual machine: starts it with the fake camera, does what the guest asks the host for, and reports what it says.

Usage: machine.py --kernel FILE --initrd FILE --disk FILE --work FOLDER [--fake PROGRAM] [FAKE_ARGUMENT...]

Prints the guest's report as it comes and ends with 0 when the guest reported to its end; run counts the results. Emulation only: nested virtualization that looks usable
often is not, so nothing here asks for it.
"""
import argparse
import hashlib
import pathlib
import signal
import socket
import subprocess
import sys
import threading
import time

BOOT_LIMIT_S = 75  # to the guest's first word
TOTAL_LIMIT_S = 300  # twice what a machine takes that has a processor to itself: scenarios have limits of their own


class FakeCamera:
    """fake-kinect-usbredir: the camera on the machine's USB port, unplugged at first."""

    def __init__(self, program, arguments, work, log):
        self.socket_path = work / "usb.sock"
        self._control_path = work / "control.sock"
        self._served = work / "served"
        self._process = None
        if not program:
            return
        self._served.mkdir(exist_ok=True)
        for path in (self.socket_path, self._control_path):
            path.unlink(missing_ok=True)
        command = [program, "--unplugged", "--socket", str(self.socket_path), "--control", str(self._control_path),
                   "--served", str(self._served), *arguments]
        self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        end = time.monotonic() + 60
        while not (self.socket_path.exists() and self._control_path.exists()):
            if self._process.poll() is not None or time.monotonic() > end:
                raise SystemExit("the fake camera did not start, see fake.log")
            time.sleep(0.05)

    @property
    def is_there(self):
        return self._process is not None

    def command(self, line):
        """One line to its control socket; "done", or what it says instead."""
        if not self.is_there:
            return "no fake camera in this build"
        with socket.socket(socket.AF_UNIX) as client:
            client.settimeout(10)
            client.connect(str(self._control_path))
            client.sendall(line.encode() + b"\n")
            client.shutdown(socket.SHUT_WR)
            answer = client.makefile().readline().strip()
        return "done" if answer == "ok" else answer

    def has_served(self, stream, digest):
        """Whether a raw frame with that MD5 left the camera."""
        return any(hashlib.md5(path.read_bytes()).hexdigest() == digest for path in self._served.glob(f"{stream}-*.raw"))

    def close(self):
        if self.is_there:
            self._process.terminate()
            try:
                self._process.wait(5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()


class Machine:
    def __init__(self, options):
        self._work = pathlib.Path(options.work)
        self._log = open(self._work / "fake.log", "ab")
        self._report = open(self._work / "report", "w", encoding="utf-8")
        self._patience = options.patience
        self._fake = FakeCamera(options.fake, options.fake_arguments, self._work, self._log)
        command = ["qemu-system-x86_64", "-machine", "q35", "-accel", "tcg,thread=multi", "-cpu", "max", "-smp", "2", "-m", "1024",
                   "-nodefaults", "-nic", "none", "-display", "none", "-no-reboot",
                   "-kernel", options.kernel, "-initrd", options.initrd,
                   # no_timer_check: the check of the emulated timer fails now and then on a busy host.
                   "-append", "console=ttyS0 quiet no_timer_check panic=-1 systemd.show_status=false",
                   "-drive", f"file={options.disk},format=raw,if=virtio,cache=unsafe,snapshot=on", "-device", "usb-ehci,id=usb",
                   "-serial", f"file:{self._work / 'console.log'}", "-serial", "stdio"]
        if self._fake.is_there:
            command += ["-chardev", f"socket,id=camera,path={self._fake.socket_path}", "-device", "usb-redir,chardev=camera,bus=usb.0"]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._log)

    def answer(self, request):
        """Carries out what the guest asked for: a command of the camera, or "served STREAM MD5"."""
        if request.startswith("served "):
            _, stream, digest = request.split()
            return "done" if self._fake.has_served(stream, digest) else "the camera sent no such frame"
        try:
            return self._fake.command(request)
        except OSError as error:
            return str(error)

    def run(self):
        """Prints the report. True when the guest came to its end."""
        is_over = False
        heard = threading.Event()
        boot_guard = threading.Timer(BOOT_LIMIT_S * self._patience, lambda: heard.is_set() or self._process.kill())
        total_guard = threading.Timer(TOTAL_LIMIT_S * self._patience, self._process.kill)
        boot_guard.start()
        total_guard.start()
        try:
            for raw in self._process.stdout:
                line = raw.decode(errors="replace").rstrip()
                if line:
                    heard.set()
                if line.startswith("@"):
                    self._process.stdin.write((self.answer(line[1:]) + "\n").encode())
                    self._process.stdin.flush()
                    continue
                print(line, flush=True)
                print(line, file=self._report, flush=True)
                is_over = is_over or line == "# over"
                if is_over:
                    break
        finally:
            boot_guard.cancel()
            total_guard.cancel()
        return is_over

    def close(self):
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._fake.close()
        self._log.close()
        self._report.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("kernel", "initrd", "disk", "work"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("--patience", type=int, default=2, help="factor on all time limits")
    parser.add_argument("--fake", help="fake-kinect-usbredir; further arguments are for it")
    options, options.fake_arguments = parser.parse_known_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    machine = Machine(options)
    try:
        return 0 if machine.run() else 1
    finally:
        machine.close()


if __name__ == "__main__":
    sys.exit(main())
