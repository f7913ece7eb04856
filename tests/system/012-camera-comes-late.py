#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""A recording folder that does not exist is NO_CAMERA with a retry; a daemon without a source stays up."""
from scenario import add_route, scenario

with scenario() as (folder, start, tap):
    add_route()
    listener = tap()
    daemon = start(source__url=f"replay://{folder}/later").wait_started()
    daemon.log.wait_for("no camera: ")
    assert "later" in daemon.wait_state("NO_CAMERA")["state_text"]
    listener.wait_for("status", lambda m: m["state"] == "0" and "later" in m["text"], "status with the reason")
    assert len(daemon.log.matching("warning: no camera")) == 1, "said once, not at every retry"
    assert listener.messages("pose") == []
    assert daemon.stop() == 0
    daemon = start(source__url="").wait_started()
    assert daemon.wait_state("NO_CAMERA")["state_text"] == "source.url is not set"
    assert daemon.command("reload")["ok"]
    assert daemon.stop() == 0
