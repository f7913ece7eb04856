# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""What the scenarios with a Kinect share: a walk through the sample room that the fake Kinect shows, a map of that room, and a
daemon that watches it.

CAMLOC_SOAK=1 makes them long: a minute of frames, a hundred unplugs, fifty kills.
"""
import contextlib
import os
import subprocess
import time

from fake_kinect import FakeKinect, require
from scenario import scenario, wait_until

CAMLOC = os.environ["CAMLOC"]
CAMLOC_MAP = os.environ["CAMLOC_MAP"]
IS_SOAK = os.environ.get("CAMLOC_SOAK") == "1"


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=120, check=False, **options)
    assert done.returncode == 0, f"{command}: exit {done.returncode}: {done.stderr}"
    return done.stdout


def make_room(folder, num_frames=150):
    """Writes walk/ and room.cmap."""
    run(CAMLOC, "record", "--source", f"sample://?rate_hz=0&frames={num_frames}", "--out", folder / "walk")
    run(CAMLOC_MAP, "build", "--sequence", folder / "walk", "--camera", folder / "walk" / "camera.toml", "--out", folder / "room.cmap")


def states_since(tap, start):
    return [int(message["state"]) for message in tap.messages("pose")[start:]]


LOCALIZED = 4


def wait_localized(tap, patience_s=30):
    """Until a pose that is still to come is LOCALIZED; returns how long it took."""
    begin = time.monotonic()
    seen = len(tap.messages("pose"))
    wait_until(lambda: LOCALIZED in states_since(tap, seen), "a localized pose", patience_s)
    return time.monotonic() - begin


@contextlib.contextmanager
def kinect_scenario(*options):
    """Gives (folder, kinect, start, tap): `start` makes a daemon on the fake Kinect, which shows the walk."""
    require()
    with scenario() as (folder, start, tap):
        make_room(folder)
        with FakeKinect(folder, "--folder", folder / "walk", *options) as kinect:

            def start_on_kinect(**settings):
                return start(environment=kinect.environment,
                             **{"source__url": "kinect://", "map__path": folder / "room.cmap", "source__retry_ms": 500, **settings}).wait_started()

            yield folder, kinect, start_on_kinect, tap
