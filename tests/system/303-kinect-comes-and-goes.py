#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Silent, unplugged, plugged in again, killed in the middle: poses come back by themselves, and nothing is left behind."""
import os
import pathlib
import time

from kinect_scene import IS_SOAK, kinect_scenario, wait_localized
from scenario import add_route, wait_until

NUM_UNPLUGS = 100 if IS_SOAK else 4
NUM_KILLS = 50 if IS_SOAK else 2
PATIENCE_S = 2 if IS_SOAK else 15


def num_descriptors(daemon):
    return len(os.listdir(f"/proc/{daemon.process.pid}/fd"))


def resident_kb(daemon):
    fields = dict(line.split(":", 1) for line in pathlib.Path(f"/proc/{daemon.process.pid}/status").read_text().splitlines())
    return int(fields["VmRSS"].split()[0])


def longest(times):
    return f"{max(times):.2f} s at most, {sorted(times)[len(times) // 2]:.2f} s median"


with kinect_scenario("--unplugged") as (folder, kinect, start, tap):
    add_route()
    listener = tap()
    daemon = start()
    wait_until(lambda: daemon.command("status")["camera_state"] == "missing", "that no camera at start is normal")
    kinect.replug()
    wait_localized(listener)

    # Silent: noticed, and the stream is started again.
    kinect.stall("both")
    begin = time.monotonic()
    daemon.wait_state("NO_CAMERA")
    print(f"stall noticed after {1000 * (time.monotonic() - begin):.0f} ms")
    wait_until(lambda: daemon.command("status")["device_resets"] > 0, "the whole ladder")
    status = daemon.command("status")
    assert status["camera_stalls"] == 1 and status["stream_restarts"] >= 1 and status["device_reopens"] >= 1, status
    kinect.resume()
    wait_localized(listener)
    assert daemon.command("status")["last_recovery_ms"] > 250

    baseline = num_descriptors(daemon), resident_kb(daemon)
    times = []
    for _ in range(NUM_UNPLUGS):
        kinect.unplug()
        daemon.wait_state("NO_CAMERA")
        kinect.replug()
        times.append(wait_localized(listener, PATIENCE_S))
    print(f"{NUM_UNPLUGS} times unplugged: localized again after {longest(times)}")
    # A connection or two may be open at any moment; what leaks grows with every unplugging.
    assert num_descriptors(daemon) <= baseline[0] + 2, (baseline, num_descriptors(daemon))
    print(f"descriptors {baseline[0]} -> {num_descriptors(daemon)}, resident {baseline[1]} -> {resident_kb(daemon)} kB")
    assert resident_kb(daemon) < baseline[1] + 4096, (baseline, resident_kb(daemon))
    assert daemon.stop() == 0

    times = []
    for _ in range(NUM_KILLS):
        daemon = start()
        times.append(wait_localized(listener, PATIENCE_S))
        daemon.process.kill()
        daemon.process.wait()
        wait_until(lambda: kinect.counts()["usbfs"]["open_sessions"] == 0, "the dead daemon's device files closed")
    print(f"{NUM_KILLS} times killed: localized after {longest(times)} from the start of the next")
    daemon = start()
    wait_localized(listener)
    assert daemon.stop() == 0
