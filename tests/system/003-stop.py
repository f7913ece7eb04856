#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""SIGTERM and SIGINT end the daemon within a second in every state, with 0, and the socket file goes away."""
import signal
import time

from scenario import SAMPLE, add_route, make_map, scenario

LIMIT_S = 1.0
SLACK_S = 2.0  # for a loaded machine; the daemon's own bound is half a second

with scenario() as (folder, start, tap):
    add_route()
    make_map(folder / "map.cmap")
    cases = [
        ("running", {}, signal.SIGTERM),
        ("interrupted", {}, signal.SIGINT),
        ("no camera", {"source__url": "replay:///nowhere", "source__camera": "", "source__retry_ms": 60000}, signal.SIGTERM),
        ("no source", {"source__url": ""}, signal.SIGTERM),
        ("no map", {"map__path": folder / "none.cmap"}, signal.SIGTERM),
        ("slow source", {"source__url": SAMPLE + "&rate_hz=0.01"}, signal.SIGTERM),
        ("recording over", {"source__url": SAMPLE + "&frames=1"}, signal.SIGTERM),
    ]
    for name, settings, number in cases:
        daemon = start(**settings).wait_started()
        time.sleep(0.3)
        daemon.signal(number)
        begin = time.monotonic()
        assert daemon.wait() == 0, name
        assert time.monotonic() - begin < LIMIT_S + SLACK_S, name
        assert not daemon.socket.exists(), name
