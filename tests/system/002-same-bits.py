#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""The same input gives the same poses, to the last printed digit."""
from scenario import SAMPLE, add_route, make_map, scenario, wait_until

with scenario() as (folder, start, tap):
    add_route()
    make_map(folder / "map.cmap")
    runs = []
    for _ in range(2):
        listener = tap()
        daemon = start(source__url=f"{SAMPLE}&frames=40&rate_hz=0", source__exit_at_end="true", source__lossless="true")
        assert daemon.wait() == 0
        poses = wait_until(lambda: len(listener.messages("pose")) >= 40 and listener.messages("pose"), "all poses")
        runs.append([{key: value for key, value in pose.items() if key != "received"} for pose in poses])
    assert runs[0] == runs[1]
