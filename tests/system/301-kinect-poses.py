#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""From the camera to the pose: a Kinect shows a room, the daemon says where it is, as it does for a recording of the same frames."""
import statistics

from fake_kinect import FakeKinect
from kinect_scene import CAMLOC, IS_SOAK, LOCALIZED, kinect_scenario, run, wait_localized
from scenario import add_route, wait_until

SECONDS = 60 if IS_SOAK else 3


def poses_by_sequence(tap, since=0):
    return {int(m["seq"]): tuple(float(m[axis]) for axis in "xyz") for m in tap.messages("pose")[since:] if int(m["state"]) == LOCALIZED}


def distance(a, b):
    return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5


with kinect_scenario("--wait-for-both", "--at-end", "hold") as (folder, kinect, start, tap):
    add_route()
    listener = tap()
    daemon = start()
    wait_localized(listener)
    wait_until(lambda: len(listener.messages("pose")) > 30 * SECONDS, "poses at the rate of the camera", 3 * SECONDS + 30)
    status = daemon.command("status")
    assert status["camera_state"] == "streaming", status
    assert status["packets_lost"] == 0 and status["frames_incomplete"] == 0, status
    poses = listener.messages("pose")
    assert sum(int(m["state"]) == LOCALIZED for m in poses) > 0.9 * len(poses), "the walk is inside the map"
    delays_ms = sorted((int(m["received"]) - int(m["utime"])) / 1000 for m in poses)
    print(f"{len(poses)} poses, {status['frames_dropped']} frames dropped; from capture stamp to subscriber "
          f"{statistics.median(delays_ms):.1f} ms median, {delays_ms[int(0.99 * len(delays_ms))]:.1f} ms p99")
    assert delays_ms[0] > 0, "nothing arrives before it was seen"
    assert daemon.stop() == 0
    live = poses_by_sequence(listener)

    # The same frames once more, now through a recording. The show starts anew with a new device.
    with FakeKinect(folder, "--folder", folder / "walk", "--wait-for-both", "--at-end", "hold") as again:
        run(CAMLOC, "record", "--source", "kinect://", "--frames", 90, "--out", folder / "recording", env=again.environment)
    seen = len(listener.messages("pose"))
    replay = start(source__url=f"replay://{folder}/recording", source__lossless="true", source__exit_at_end="true")
    assert replay.wait() == 0
    recorded = poses_by_sequence(listener, seen)
    # Both count their frames from their first one, which need not be the same of the show.
    best = min((statistics.median(distance(live[i + shift], recorded[i]) for i in recorded if i + shift in live), shift)
               for shift in range(-3, 4) if sum(i + shift in live for i in recorded) > 40)
    print(f"live and recorded poses differ by {1000 * best[0]:.3f} mm (median)")
    assert best[0] < 0.001, best
