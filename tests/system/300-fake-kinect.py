#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""libfreenect streams from the fake Kinect, is killed, unplugged and starved, and its next start finds a device that works."""
import os
import subprocess
import sys
import tempfile
import time

from fake_kinect import SKIPPED, FakeKinect, require
from scenario import wait_until

require()
if "FAKE_KINECT_CHECK" not in os.environ:
    print("skipped: no fake_kinect_check, as libfreenect-dev is not installed")
    sys.exit(SKIPPED)


def start(kinect, seconds):
    command = [os.environ["FAKE_KINECT_CHECK"], "--log", str(kinect.log_path), "--seconds", str(seconds)]
    return subprocess.Popen(command, env=kinect.environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def wait_streaming(kinect):
    """Until frames of both streams went to somebody who listens, from now on."""
    def whole(stream):
        counts = kinect.counts()[stream]
        return counts["frames"] - counts["damaged"]
    before = {stream: whole(stream) for stream in ("video", "depth")}
    wait_until(lambda: all(whole(stream) > before[stream] + 3 for stream in before), "frames of both streams")


def check_streams(kinect):
    client = start(kinect, 1.5)
    output, _ = client.communicate(timeout=60)
    assert client.returncode == 0, output
    assert output.count(" 0 wrong") == 2, output


with tempfile.TemporaryDirectory(prefix="camloc_") as folder, FakeKinect(folder) as kinect:
    check_streams(kinect)

    for _ in range(3):  # killed in the middle: what is open is closed, the streams are left on
        client = start(kinect, 60)
        wait_streaming(kinect)
        client.kill()
        client.wait()
        wait_until(lambda: kinect.counts()["usbfs"]["open_sessions"] == 0, "the dead client's files closed")
    check_streams(kinect)

    for _ in range(3):  # unplugged in the middle: libfreenect gives up, its next start finds the new device
        client = start(kinect, 60)
        wait_streaming(kinect)
        kinect.unplug()
        client.communicate(timeout=60)
        kinect.replug()
    check_streams(kinect)
    assert kinect.counts()["power_cycles"] == 3

    kinect.stall("both")
    client = start(kinect, 1)
    client.communicate(timeout=60)
    assert client.returncode == 1, "no frames from a stalled device"
    kinect.resume()
    check_streams(kinect)

    kinect.fault("loss=0.02")
    client = start(kinect, 2)
    output, _ = client.communicate(timeout=60)
    assert kinect.counts()["faults"]["loss"] > 50, kinect.counts()
    kinect.fault("loss=0")
    damaged = [frame for frame in kinect.frames() if frame.damaged]
    assert damaged
    time.sleep(0.1)
    check_streams(kinect)
print("passed")
