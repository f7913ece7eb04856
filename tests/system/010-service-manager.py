#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""READY even with nothing there, STATUS, RELOADING with its time, WATCHDOG while things move, STOPPING.

That a hanging source starves the watchdog and does not hold up the stop is in tests/daemon (ProgressWatch, CaptureThread).
"""
import signal
import time

from scenario import Manager, add_route, make_map, scenario

with scenario() as (folder, start, tap):
    manager = Manager(folder / "notify")
    environment = {"NOTIFY_SOCKET": str(manager.path), "WATCHDOG_USEC": "800000"}

    # No camera, no map, no route: that is a state, not a failure to start.
    daemon = start(environment=environment, source__url="replay:///nowhere")
    manager.wait_for("READY=1")
    manager.wait_for("STATUS=")
    manager.wait_for("WATCHDOG=1")
    daemon.signal(signal.SIGTERM)
    manager.wait_for("STOPPING=1")
    assert daemon.wait() == 0

    add_route()
    make_map(folder / "map.cmap")
    manager.heard.clear()
    daemon = start(environment=environment)
    manager.wait_for("READY=1")
    daemon.wait_state("LOCALIZED")
    manager.wait_for("WATCHDOG=1")
    since = len(manager.heard)
    before_us = time.clock_gettime_ns(time.CLOCK_MONOTONIC) // 1000
    daemon.signal(signal.SIGHUP)
    manager.wait_for("RELOADING=1", since)
    manager.wait_for("READY=1", since)
    reloading = next(message for message in manager.heard[since:] if message.startswith("RELOADING=1"))
    stamp_us = int(reloading.split("MONOTONIC_USEC=")[1])
    assert before_us <= stamp_us <= time.clock_gettime_ns(time.CLOCK_MONOTONIC) // 1000
    manager.wait_for("WATCHDOG=1", len(manager.heard))
    assert daemon.stop() == 0
