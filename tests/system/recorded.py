# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""What the scenarios on recorded sequences share: where programs, cameras and recordings are, and a folder to work in."""
import contextlib
import os
import pathlib
import subprocess
import sys
import tempfile

CAMLOC = os.environ["CAMLOC"]
CAMLOC_MAP = os.environ["CAMLOC_MAP"]
CAMLOC_BENCH = os.environ["CAMLOC_BENCH"]
SOURCE = pathlib.Path(__file__).resolve().parents[2]
CAMERAS = SOURCE / "config" / "cameras"
DATA = pathlib.Path(os.environ.get("CAMLOC_DATA", SOURCE.parent / "shared" / "data"))
SKIPPED = 77


def run(*arguments):
    """What the program printed; it must end with 0."""
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{arguments}: exit {done.returncode}: {done.stderr}"
    return done.stdout


@contextlib.contextmanager
def work_folder():
    """A folder that goes away; skips the scenario where there are no recordings."""
    if not (DATA / "kitchen").is_dir():
        print(f"skipped: no recorded sequences in {DATA}")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory(prefix="camloc_") as folder:
        yield pathlib.Path(folder)
