#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""The second daemon on a control socket refuses to start and leaves the first alone; a dead daemon's socket is replaced."""
import signal

from scenario import add_route, scenario

with scenario() as (folder, start, tap):
    add_route()
    first = start().wait_started()
    second = start()
    assert second.wait() == 1
    assert len(second.log.lines) == 1 and "is in use: another camlocd runs" in second.log.lines[0], second.log.lines
    assert first.command("status")["ok"]
    first.signal(signal.SIGKILL)
    assert first.wait() == -signal.SIGKILL
    assert first.socket.exists(), "nobody was there to remove it"
    third = start().wait_started()
    assert third.command("status")["ok"]
    assert third.stop() == 0
