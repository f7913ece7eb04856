#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""A synthetic flat mapped without poses on one day and localized in on another, where the truth is known to the millimetre: the map is
true, no pose misleads, and the covariances are as large as the errors."""
import json
import os
import pathlib
import sys
import tempfile

from recorded import CAMLOC, CAMLOC_MAP, SKIPPED, run

CAMLOC_SIM = os.environ.get("CAMLOC_SIM", "")


def errors(estimate, reference, *alignment):
    return json.loads(run(CAMLOC, "eval", "--estimate", estimate, "--reference", reference, "--json", *alignment))


def main():
    if not CAMLOC_SIM:
        print("skipped: camloc-sim is not built, it makes the recordings")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory(prefix="camloc_") as folder:
        work = pathlib.Path(folder)
        run(CAMLOC_SIM, "--scene", "small", "--seed", "2", "--rate-hz", "6", "--out", work / "sim")
        mapping, day2, camera = work / "sim" / "mapping", work / "sim" / "day2", work / "sim" / "camera.toml"
        flat, walk, found = work / "flat.cmap", work / "walk.tum", work / "found.tum"

        summary = json.loads(run(CAMLOC_MAP, "build", "--sequence", mapping, "--camera", camera, "--out", flat, "--trajectory", walk, "--json"))
        slam = summary["slam"]   # six frames a second leave little overlap in a turn before a bare wall
        assert slam["lost"] <= 0.05 * slam["views"] and slam["loops"]["closed"] > 0 and not summary["submaps"], summary
        assert 0.0003 < summary["deformation"]["sigma_m"] < 0.02, summary["deformation"]
        assert errors(walk, mapping, "--align", "se3")["translation_m"]["rmse"] < 0.02

        scan = json.loads(run(CAMLOC_MAP, "eval", flat, "--lidar", work / "sim" / "lidar.ply", "--json"))
        assert scan["distances"]["landmark_to_surface"]["median_m"] < 0.01, scan
        assert abs(scan["scale"]["icp"] - 1) < 0.005, scan

        for mode in ("single", "track"):
            run(CAMLOC, "localize", "--map", flat, "--sequence", day2, "--camera", camera, "--mode", mode, "--out", found)
            day = errors(found, day2, "--align-by", walk, "--align-reference", mapping)
            assert day["misleading"] == 0, day
            assert day["localized"] > 0.85 * day["frames"], day
            assert day["translation_m"]["median"] < 0.015, day
            assert day["inside_95"] > 0.8, day


if __name__ == "__main__":
    main()
