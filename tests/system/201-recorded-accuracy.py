#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Real Kinect recordings: accurate inside the map whatever the light, never localized elsewhere, a wrong calibration noticed.

The bars are those of the project, not of this data: within 5 cm / 5 deg inside the map, no misleading pose outside it.
"""
import json

from recorded import CAMERAS, CAMLOC, CAMLOC_MAP, DATA, run, work_folder


class Place:
    """A recording with its camera, and the map of a part of it."""

    def __init__(self, folder, camera, work):
        self.sequence, self.camera, self.work = DATA / folder, CAMERAS / camera, work

    def map(self, *selection):
        path = self.work / f"{self.sequence.name}{'_'.join(selection).replace(':', '.')}.cmap"
        if not path.exists():
            run(CAMLOC_MAP, "build", "--sequence", self.sequence, "--camera", self.camera, "--poses", "embedded", "--out", path, *selection)
        return path

    def localize(self, map_path, *options, camera=None):
        """Errors against the truth, the records of all frames, and what was printed."""
        trajectory, records = self.work / "trajectory.tum", self.work / "records.json"
        said = run(CAMLOC, "localize", "--map", map_path, "--sequence", self.sequence, "--camera", camera or self.camera, "--out", trajectory,
                   "--json", records, *options)
        return trajectory, json.loads(records.read_text())["frames"], said

    def errors(self, map_path, *options):
        trajectory, _, _ = self.localize(map_path, *options)
        return json.loads(run(CAMLOC, "eval", "--estimate", trajectory, "--reference", self.sequence, "--json"))


def check_inside(kitchen):
    mapped = kitchen.map("--exclude", "::50")
    for perturbation in ([], ["gamma=0.5"], ["gamma=1.8"], ["contrast=0.6"], ["blur=9"], ["noise=12"], ["exposure=0.4"]):
        options = ["--perturb", *perturbation] if perturbation else []
        errors = kitchen.errors(mapped, "--frames", "::50", "--mode", "single", *options)
        assert errors["within"]["5cm_5deg"] == 1.0, (perturbation, errors)
        assert perturbation or errors["translation_m"]["median"] <= 0.01, errors


def check_held_out(kitchen):
    mapped = kitchen.map("--frames", "0:300")
    single = kitchen.errors(mapped, "--frames", "300:600:5", "--mode", "single")
    track = kitchen.errors(mapped, "--frames", "300:600:5", "--mode", "track")
    assert single["misleading"] == 0 and track["misleading"] == 0, (single, track)
    assert track["within"]["10cm_10deg"] >= max(0.9, single["within"]["10cm_10deg"]), (single, track)


def check_other_sequence(room, mapped, work):
    errors = Place("tum_fr1_xyz", "tum-fr1.toml", work).errors(mapped, "--mode", "single")
    assert errors["within"]["5cm_5deg"] == 1.0 and errors["translation_m"]["median"] <= 0.02, errors


def check_elsewhere(visitors):
    for place, mapped, selection in visitors:
        for mode in ("single", "track"):
            _, frames, said = place.localize(mapped, "--frames", selection, "--mode", mode)
            wrong = [frame["index"] for frame in frames if frame["state"] == "LOCALIZED"]
            assert not wrong, (place.sequence, mapped, wrong)
            assert "WARNING" not in said, said


def check_wrong_focal_length(kitchen, work):
    camera = work / "wrong.toml"
    text = kitchen.camera.read_text()
    assert "fx = 525" in text and "fy = 525" in text
    camera.write_text(text.replace("fx = 525", "fx = 450").replace("fy = 525", "fy = 450"))
    _, frames, said = kitchen.localize(kitchen.map("--exclude", "::50"), "--frames", "0:100", camera=camera)
    assert "calibration" in said, said
    assert all(frame["state"] != "LOCALIZED" for frame in frames)


def main():
    with work_folder() as work:
        kitchen, room = Place("kitchen", "7scenes.toml", work), Place("tum_fr1_rpy", "tum-fr1.toml", work)
        elsewhere = Place("elsewhere", "kinect-v1.toml", work)
        kitchen_map, room_map = kitchen.map("--exclude", "::50"), room.map()
        check_inside(kitchen)
        check_held_out(kitchen)
        check_other_sequence(room, room_map, work)
        check_elsewhere([(elsewhere, kitchen_map, ":"), (elsewhere, room_map, ":"), (kitchen, room_map, "::20"), (room, kitchen_map, "::20")])
        check_wrong_focal_length(kitchen, work)


if __name__ == "__main__":
    main()
