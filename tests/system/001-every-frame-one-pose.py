#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""A recording is localized to its end: one pose per frame, in order, verified; the program exits with 0 when told to."""
from scenario import SAMPLE, add_route, make_map, scenario, wait_until

NUM_FRAMES = 60

with scenario() as (folder, start, tap):
    add_route()
    make_map(folder / "map.cmap")
    listener = tap()
    daemon = start(source__url=f"{SAMPLE}&frames={NUM_FRAMES}", source__exit_at_end="true", source__lossless="true")
    assert daemon.wait() == 0
    poses = wait_until(lambda: len(listener.messages("pose")) >= NUM_FRAMES and listener.messages("pose"), "all poses")
    assert [int(pose["seq"]) for pose in poses] == list(range(NUM_FRAMES))
    localized = [pose for pose in poses if pose["state"] == "4"]
    assert len(localized) >= 0.9 * NUM_FRAMES, f"{len(localized)} of {NUM_FRAMES} localized"
    assert len({pose["map"] for pose in poses}) == 1 and poses[0]["map"] != "0" * 16
    assert len(listener.messages("bot_core")) == len(localized), "bot_core.pose_t only while LOCALIZED"
    listener.wait_for("status", lambda m: m["text"] == "recording over" and m["published"] == str(NUM_FRAMES), "last status")
    assert not daemon.socket.exists()
