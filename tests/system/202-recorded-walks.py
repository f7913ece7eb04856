#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Maps of real Kinect walks without their poses: nothing lost, trajectories and surfaces true, good to localize in, depth wins.

The reference of the kitchen is itself good to about 4 cm only; that of the office is motion capture.
"""
import json

from recorded import CAMERAS, CAMLOC, CAMLOC_BENCH, CAMLOC_MAP, DATA, run, work_folder


class Walk:
    """A map of a recording, made without its poses, and what it is worth."""

    def __init__(self, folder, camera, work, *options):
        self.sequence, self.camera = DATA / folder, CAMERAS / camera
        name = "_".join([folder, *options]).replace("-", "")
        self.map, self.trajectory = work / f"{name}.cmap", work / f"{name}.tum"
        self.summary = json.loads(run(CAMLOC_MAP, "build", "--sequence", self.sequence, "--camera", self.camera, "--out", self.map,
                                      "--trajectory", self.trajectory, "--json", *options))

    def trajectory_error_m(self):
        errors = json.loads(run(CAMLOC, "eval", "--estimate", self.trajectory, "--reference", self.sequence, "--align", "se3",
                                "--camera", self.camera, "--json"))
        return errors["translation_m"]["rmse"]

    def surface(self):
        """Landmarks against the cloud that true poses and raw depth make."""
        return json.loads(run(CAMLOC_MAP, "eval", self.map, "--reference-sequence", self.sequence, "--camera", self.camera,
                              "--trajectory", self.trajectory, "--json"))

    def localize_m(self, folder, work):
        """Median error of another recording in this map, aligned by the walk itself."""
        found = work / "found.tum"
        run(CAMLOC, "localize", "--map", self.map, "--sequence", DATA / folder, "--camera", self.camera, "--mode", "single", "--out", found)
        return json.loads(run(CAMLOC, "eval", "--estimate", found, "--reference", DATA / folder, "--align-by", self.trajectory,
                              "--align-reference", self.sequence, "--json"))


def agreement_of_held_out_frames(work, *known_poses):
    """Frames 300 to 599 localized in a map of the first 300, against the images of those: the epipolar error in pixels.

    The reference of the kitchen disagrees with its own images by more than the map does, so it cannot say which map is better.
    """
    sequence, camera = DATA / "kitchen", CAMERAS / "7scenes.toml"
    first_half, found, walk = work / "half.cmap", work / "held_out.tum", work / "half.tum"
    mapped = ["--mapped", sequence, "--mapped-frames", "0:300"] if known_poses else ["--mapped", walk]
    run(CAMLOC_MAP, "build", "--sequence", sequence, "--camera", camera, "--out", first_half, "--frames", "0:300",
        *(known_poses or ("--trajectory", walk)))
    run(CAMLOC, "localize", "--map", first_half, "--sequence", sequence, "--camera", camera, "--frames", "300:600:5", "--mode", "single",
        "--out", found)
    return json.loads(run(CAMLOC, "epipolar", "--estimate", found, "--sequence", sequence, "--camera", camera, *mapped, "--json"))


def flattened(walk, work):
    """The same walk as it is, and without depth in tracking and adjustments."""
    return json.loads(run(CAMLOC_BENCH, "slam", "--sequence", walk.sequence, "--camera", walk.camera, "--keep", work / "flat",
                          "--set", "slam.depth_in_tracking=0", "--set", "slam.depth_in_adjustment=0", "--json"))


def mean_to_point_m(report):
    return report["distances"]["landmark_to_point"]["mean_m"]


def main():
    with work_folder() as work:
        kitchen = Walk("kitchen", "7scenes.toml", work)
        assert kitchen.summary["slam"]["lost"] == 0, kitchen.summary
        assert kitchen.summary["slam"]["reprojection_error_px"]["median"] <= 0.6, kitchen.summary
        assert kitchen.trajectory_error_m() <= 0.05
        surface = kitchen.surface()
        assert mean_to_point_m(surface) <= 0.01, surface

        without, given = agreement_of_held_out_frames(work), agreement_of_held_out_frames(work, "--poses", "embedded")
        assert without["poses_compared"] >= given["poses_compared"] - 2, (without, given)
        assert without["epipolar_error_px"]["median"] <= 0.7, without
        assert without["epipolar_error_px"]["median"] < 0.8 * given["epipolar_error_px"]["median"], (without, given)
        assert without["epipolar_error_px"]["p90"] < 0.5 * given["epipolar_error_px"]["p90"], (without, given)

        room = Walk("tum_fr1_rpy", "tum-fr1.toml", work)
        assert room.summary["slam"]["lost"] == 0, room.summary
        assert room.trajectory_error_m() <= 0.03
        surface_with_depth = room.surface()
        errors = room.localize_m("tum_fr1_xyz", work)
        assert errors["within"]["5cm_5deg"] == 1.0 and errors["translation_m"]["median"] <= 0.02, errors

        flat = flattened(room, work)
        assert flat["changed"]["trajectory_error_m"]["rmse"] > flat["default"]["trajectory_error_m"]["rmse"], flat
        assert abs(flat["default"]["trajectory_error_m"]["rmse"] - room.trajectory_error_m()) < 1e-4, flat
        room.map, room.trajectory = work / "flat" / "changed.cmap", work / "flat" / "changed.tum"
        assert mean_to_point_m(room.surface()) > mean_to_point_m(surface_with_depth)


if __name__ == "__main__":
    main()
