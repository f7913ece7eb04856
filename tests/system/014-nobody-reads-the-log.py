#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""A stderr that is full, closed, broken or a full disk costs log lines, which are counted, and nothing else.

CAMLOC_SOAK=1: 3,000 reloads instead of 5.
"""
import contextlib
import fcntl
import os
import socket
import subprocess
import time

from scenario import add_route, make_map, scenario, wait_until

NUM_RELOADS = 3000 if os.environ.get("CAMLOC_SOAK") else 5


def full_pipe():
    """Read end, write end; as a reader leaves it that stopped."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETFL, os.O_NONBLOCK)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, b"x")
    fcntl.fcntl(writer, fcntl.F_SETFL, 0)
    return reader, writer


def exercise(name, daemon, are_lines_lost=True):
    """Poses, control and stop as ever."""
    wait_until(daemon.socket.exists, f"{name}: control socket")
    daemon.wait_state("LOCALIZED")
    for _ in range(NUM_RELOADS):
        assert daemon.command("reload") == {"ok": True}, name
    before = daemon.command("status")
    assert (before["log_lines_lost"] > 0) == are_lines_lost, (name, before)
    wait_until(lambda: daemon.command("status")["frames_localized"] > before["frames_localized"], f"{name}: frames go on")


def end(name, daemon):
    begin = time.monotonic()
    assert daemon.stop() == 0, name
    assert time.monotonic() - begin < 3, name


with scenario() as (folder, start, tap):
    add_route()
    make_map(folder / "map.cmap")
    reader, writer = full_pipe()
    daemon = start(stderr=writer)
    exercise("full pipe", daemon)
    # Read at last: the next line says what is missing.
    os.set_blocking(reader, False)
    heard = []

    def is_told():
        daemon.command("reload")
        with contextlib.suppress(BlockingIOError):
            heard.append(os.read(reader, 1 << 20).decode())
        return "lines lost, nobody took them" in heard[-1] and "reloaded" in heard[-1]

    heard.append(os.read(reader, 1 << 20).decode())
    wait_until(is_told, "what is missing is said")
    end("full pipe", daemon)

    os.close(reader)
    daemon = start(stderr=writer)
    exercise("closed pipe", daemon)
    end("closed pipe", daemon)

    with open("/dev/full", "wb") as full:
        daemon = start(stderr=full)
    exercise("full disk", daemon)
    end("full disk", daemon)

    near, far = socket.socketpair()
    near.setblocking(False)
    with contextlib.suppress(BlockingIOError):
        while True:
            near.send(b"x" * 4096)
    near.setblocking(True)
    daemon = start(stderr=near)
    exercise("full socket", daemon)
    end("full socket", daemon)

    # Without a stderr at all no file or socket of the daemon gets its number, and the log lines.
    daemon = start(shell="exec 2>&-", stderr=subprocess.DEVNULL)
    exercise("no stderr", daemon, are_lines_lost=False)
    assert os.readlink(f"/proc/{daemon.process.pid}/fd/2") == "/dev/null"
    end("no stderr", daemon)

    # One that cannot start says so and ends, whoever listens.
    reader, writer = full_pipe()
    daemon = start(stderr=writer, source__url="nonsense://")
    assert daemon.process.wait(10) == 2
