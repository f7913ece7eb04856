#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Reload swaps maps between two frames; a bad map or a bad configuration keeps everything as it was."""
import signal

from scenario import add_route, make_map, scenario

with scenario() as (folder, start, tap):
    add_route()
    map_path = folder / "map.cmap"
    make_map(map_path)
    listener = tap()
    daemon = start().wait_started()
    before = daemon.wait_state("LOCALIZED")

    # A map renamed over the old one is taken on request only.
    make_map(map_path, 570)
    assert daemon.command("status")["map_id"] == before["map_id"]
    assert daemon.command("reload") == {"ok": True}
    after = daemon.wait_state("LOCALIZED")
    assert after["map_id"] != before["map_id"]
    assert after["reset_counter"] > before["reset_counter"], "poses may jump: the counter says so"

    # A bad map.
    good = map_path.read_bytes()
    for bad in (b"", b"junk", good[: len(good) // 2], bytes([good[0] ^ 1]) + good[1:]):
        (folder / "bad").write_bytes(bad)
        (folder / "bad").rename(map_path)
        reply = daemon.command("reload")
        assert not reply["ok"] and "map.cmap" in reply["error"], reply
        status = daemon.command("status")
        assert status["map_id"] == after["map_id"] and status["state"] == "LOCALIZED"
    map_path.unlink()
    assert not daemon.command("reload")["ok"]
    assert daemon.command("status")["map_reload_failures"] == 5

    # A bad configuration, then one with a change that needs a restart, by signal.
    map_path.write_bytes(good)
    daemon.config.write_text("[localize]\nfeatures = 0\n")
    reply = daemon.command("reload")
    assert not reply["ok"] and "camlocd.toml:2: localize.features: 0 is out of range" in reply["error"], reply
    daemon.config.write_text("[publish]\npose_channel = 'OTHER'\n")
    daemon.signal(signal.SIGHUP)
    daemon.log.wait_for("need a restart: publish.pose_channel")
    daemon.log.wait_for("info: reloaded", since=len(daemon.log.lines) - 2)
    listener.wait_for_new("pose", lambda m: m["state"] == "4", "poses after all that")
    assert daemon.stop() == 0
