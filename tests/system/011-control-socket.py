#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Garbage, silence, floods and half requests on the control socket: answered or dropped, and the poses go on."""
import os
import random
import socket
import stat

from scenario import add_route, make_map, scenario, wait_until

with scenario() as (folder, start, tap):
    add_route()
    make_map(folder / "map.cmap")
    listener = tap()
    daemon = start().wait_started()
    daemon.wait_state("LOCALIZED")
    assert stat.S_IMODE(os.stat(daemon.socket).st_mode) == 0o660

    for request in (b"\n", b"nonsense\n", b"\x00\xff\xfe\n", b"status now\n", b'{"cmd":"status"}\n'):
        reply = daemon.ask(request)
        assert reply.startswith('{"ok":false,"error":"unknown command') and reply.endswith("\n"), reply
    assert "request too long" in daemon.ask(b"x" * 10000)
    generator = random.Random(1)
    for _ in range(50):
        noise = bytes(generator.randrange(256) for _ in range(generator.randrange(1, 300))) + b"\n"
        try:
            assert daemon.ask(noise).startswith('{"ok":'), noise
        except (BrokenPipeError, ConnectionResetError):
            pass  # refused while still being sent
    # Silent clients on every place, and one that never reads: others are served after they are dropped.
    silent = []
    for _ in range(12):
        client = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        client.setblocking(False)
        try:
            client.connect(str(daemon.socket))
        except BlockingIOError:
            pass  # the queue is full, which is the point
        silent.append(client)
    seen = len(listener.messages("pose"))
    wait_until(lambda: len(listener.messages("pose")) > seen + 10, "poses while clients are silent")
    assert daemon.command("status")["state"] == "LOCALIZED"
    reply = daemon.command("reset")
    assert reply == {"ok": True}
    daemon.wait_state("LOCALIZED")
    assert daemon.stop() == 0
