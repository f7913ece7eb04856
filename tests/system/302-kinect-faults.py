#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""A bad cable, a device that misbehaves: the daemon stays up, says what it loses, and has poses again within a second after it."""
from kinect_scene import IS_SOAK, kinect_scenario, wait_localized
from scenario import add_route, wait_until

PACKET_FAULTS = ("loss", "bus_error", "duplicate", "reorder", "short", "sequence_jump", "bad_magic", "bad_kind", "bad_size", "clock_jump")
NUM_FAULTS = 1000 if IS_SOAK else 60
# What is asked for is a second; a machine that tests other things meanwhile gets more.
PATIENCE_S = 1 if IS_SOAK else 10

with kinect_scenario() as (folder, kinect, start, tap):
    add_route()
    listener = tap()
    daemon = start()
    wait_localized(listener)

    for loss in (0.001, 0.01, 0.1):
        before = kinect.counts()["faults"]["loss"]
        kinect.fault(f"loss={loss}")
        wait_until(lambda: kinect.counts()["faults"]["loss"] > before + 3000 * loss, f"packets lost at {loss}")
        kinect.fault("loss=0")
        print(f"loss of {100 * loss:g} %: localized again after {wait_localized(listener, PATIENCE_S):.2f} s")
    status = daemon.wait_state("LOCALIZED")
    assert status["packets_lost"] > 0, status

    for fault in PACKET_FAULTS:
        kinect.fault(f"{fault}:{NUM_FAULTS}")
        wait_until(lambda: kinect.counts()["faults"][fault] >= NUM_FAULTS, f"{NUM_FAULTS} times {fault}")
        print(f"{NUM_FAULTS} times {fault}: localized again after {wait_localized(listener, PATIENCE_S):.2f} s")
    assert daemon.process.poll() is None
    assert daemon.stop() == 0
    assert not daemon.log.matching("error"), daemon.log.matching("error")

    # Commands that are refused, late, unanswered or answered with nonsense while the camera is opened.
    for fault in ("control_stall", "late_reply", "no_reply", "wrong_tag", "wrong_magic", "short_reply"):
        kinect.fault(f"{fault}:3")
        daemon = start()
        wait_localized(listener)
        assert daemon.stop() == 0
        kinect.fault(f"{fault}=0")
