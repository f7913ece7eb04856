#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""A map that is truncated or overwritten in place while in use does not kill the daemon: NO_MAP until it is whole again."""
from scenario import add_route, make_map, scenario

with scenario() as (folder, start, tap):
    add_route()
    map_path = folder / "map.cmap"
    make_map(map_path)
    good = map_path.read_bytes()
    daemon = start().wait_started()
    for length in (0, 4096):
        daemon.wait_state("LOCALIZED")
        with open(map_path, "r+b") as file:
            file.truncate(length)
        daemon.wait_state("NO_MAP")
        with open(map_path, "r+b") as file:
            file.write(good)
        daemon.wait_state("LOCALIZED")
    with open(map_path, "r+b") as file:
        file.write(b"\xff" * len(good))
    daemon.wait_state("NO_MAP")
    map_path.write_bytes(good)
    status = daemon.wait_state("LOCALIZED")
    assert status["reset_counter"] >= 3
    assert daemon.stop() == 0
