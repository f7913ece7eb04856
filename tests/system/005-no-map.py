#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Without a map every frame is published as NO_MAP; when the map appears it is used without any request."""
from scenario import add_route, make_map, scenario

with scenario() as (folder, start, tap):
    add_route()
    listener = tap()
    daemon = start().wait_started()
    pose = listener.wait_for("pose", lambda m: m["state"] == "1", "NO_MAP poses")
    assert pose["map"] == "0" * 16
    assert "map.cmap" in daemon.wait_state("NO_MAP")["state_text"]
    reply = daemon.command("reset")
    assert not reply["ok"] and "no map" in reply["error"]
    make_map(folder / "map.cmap")
    listener.wait_for("pose", lambda m: m["state"] == "4", "LOCALIZED poses")
    assert len(daemon.log.matching("warning: no map")) == 1, "said once, not every second"
    assert daemon.stop() == 0
