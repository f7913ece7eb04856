#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Hints over the control socket and over LCM: taken where there is a map, refused with the reason where they mean nothing."""
import os
import subprocess

from scenario import LCM_TAP, add_route, make_map, scenario, wait_until

with scenario() as (folder, start, tap):
    add_route()
    daemon = start(control__hint_channel="CAMLOC_HINT").wait_started()
    assert "no map is open" in daemon.command("hint 0 0 1.4 0 2")["error"]
    make_map(folder / "map.cmap")
    daemon.wait_state("LOCALIZED")

    assert daemon.command("hint 1.2 0 1.4 0 2") == {"ok": True}
    daemon.log.wait_for(r"hint: 1\.2 0 1\.4 m, heading 0 deg, within 2 m")
    assert "five numbers" in daemon.command("hint 1.2 0 1.4 0")["error"]
    assert "at most 20 m" in daemon.command("hint 1.2 0 1.4 0 nan")["error"]
    told = subprocess.run([os.environ["CAMLOC"], "ctl", "hint", "-1.2", "0", "1.4", "-170", "2", "--socket", str(daemon.socket)],
                          capture_output=True, text=True, timeout=30, check=False)
    assert (told.returncode, told.stdout) == (0, "hint: done\n"), told
    daemon.log.wait_for(r"hint: -1\.2 0 1\.4 m, heading -170 deg, within 2 m")

    def send(age_s, radius):
        subprocess.run([LCM_TAP, "hint", "0.5", "0.25", "1.4", "0", radius, str(age_s)], timeout=30, check=True)
        return True
    wait_until(lambda: send(0, "3") and daemon.log.matching(r"hint: 0\.5 0\.25 1\.4 m, heading 0 deg, within 3 m"), "a hint over LCM")
    wait_until(lambda: send(10, "3") and daemon.log.matching("hint over LCM refused: it is too old"), "an old hint refused")
    wait_until(lambda: send(0, "99") and daemon.log.matching("hint over LCM refused: the radius"), "a wide hint refused")
    daemon.wait_state("LOCALIZED")
    assert daemon.stop() == 0

    refused = start(control__hint_channel="CAMLOC_HINT", publish__lcm_url="udpm://239.255.76.67:7667?ttl=1")
    assert refused.wait() == 2
    assert refused.log.matching("control.hint_channel"), refused.log.lines
