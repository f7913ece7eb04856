#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Without a multicast route the daemon localizes on, says so once, and publishes as soon as there is a route."""
import time

from scenario import add_route, make_map, scenario

with scenario() as (folder, start, tap):
    make_map(folder / "map.cmap")
    daemon = start().wait_started()
    daemon.wait_state("LOCALIZED")
    time.sleep(2.5)
    assert daemon.command("status")["poses_published"] == 0
    assert len(daemon.log.matching("poses are not published")) == 1, "said once, not every second"
    assert len(daemon.log.lines) < 12, "no flood"
    add_route()
    listener = tap()
    listener.wait_for("pose", lambda m: m["state"] == "4", "poses after the route came")
    assert daemon.command("status")["poses_published"] > 0
    assert daemon.stop() == 0
