#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""camloc-map build without poses on recordings that are no walks, or half of one: each ends in one line that says what is wrong,
with the documented exit code and the old map as it was, or in a map with the weak spot named. Ctrl-C finishes a map of the first
part, and --resume makes the very map that an uninterrupted build makes."""
import contextlib
import json
import os
import pathlib
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

CAMLOC = os.environ["CAMLOC"]
CAMLOC_MAP = os.environ["CAMLOC_MAP"]
CAMLOC_SIM = os.environ.get("CAMLOC_SIM", "")
WIDTH, HEIGHT = 640, 480
UNITS_PER_M = 5000
PATIENCE_S = 60


def png(bits, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, bits, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows), 1)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def constant_depth(metres):
    return png(16, [struct.pack(">H", int(metres * UNITS_PER_M)) * WIDTH] * HEIGHT)


class Recording:
    """A copy of some frames of the generated walk. `color` and `depth` are (stamp, path) lists, written by save()."""

    def __init__(self, source, folder, frames=slice(None)):
        self.folder = folder
        for name in ("rgb", "depth"):
            (folder / name).mkdir(parents=True)
        self.color, self.depth = ([line.split() for line in (source / f"{name}.txt").read_text().splitlines() if not line.startswith("#")][frames]
                                  for name in ("rgb", "depth"))
        for _, path in self.color + self.depth:
            os.link(source / path, folder / path)

    def save(self):
        for name, lines in (("rgb", self.color), ("depth", self.depth)):
            (self.folder / f"{name}.txt").write_text("".join(f"{float(stamp):.6f} {path}\n" for stamp, path in lines))
        return self.folder

    def replace(self, path, content):
        """A file of its own instead of the link to the walk's."""
        (self.folder / path).unlink()
        (self.folder / path).write_bytes(content)


class Bench:
    """A folder with a recording, its camera and its map."""

    def __init__(self, folder):
        self.folder = folder
        made = self.run(CAMLOC_SIM, "--scene", "small", "--only", "mapping", "--duration-scale", "0.3", "--out", folder / "sim")
        assert made.returncode == 0, made
        self.camera = folder / "sim" / "camera.toml"
        self.walk = self.recording("walk", slice(0, 56)).save()
        self.num_frames = 56
        self.map = folder / "whole.cmap"
        summary = self.built(self.walk, self.map)
        assert summary["slam"]["lost"] == 0 and summary["slam"]["weak_spots"] == [] and not summary["is_partial"], summary
        self.out = folder / "out.cmap"

    def recording(self, name, frames=slice(None)):
        return Recording(self.folder / "sim" / "mapping", self.folder / name, frames)

    def run(self, *arguments, **more):
        return subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True, timeout=PATIENCE_S, **more)

    def arguments(self, sequence, out, *more):
        return [CAMLOC_MAP, "build", "--sequence", str(sequence), "--camera", str(self.camera), "--name", "walk", "--out", str(out), *more]

    def built(self, sequence, out, *more, num_lines=0):
        """The summary of a build that succeeds; `num_lines` on stderr."""
        result = self.run(*self.arguments(sequence, out, "--json", *more))
        assert result.returncode == 0 and len(result.stderr.splitlines()) == num_lines, result
        assert self.run(CAMLOC, "map", "verify", out).returncode == 0
        assert num_lines == 0 or result.stderr.startswith("camloc-map: "), result
        summary = json.loads(result.stdout)
        summary["stderr"] = result.stderr
        return summary

    def refused(self, code, text, sequence, *more):
        """One line that holds `text`; the map of before and no new file."""
        self.out.write_bytes(b"old")
        before = sorted(self.folder.rglob("*"))
        result = self.run(*self.arguments(sequence, self.out, *more))
        assert result.returncode == code and result.stdout == "", result
        assert len(result.stderr.splitlines()) == 1 and result.stderr.startswith("camloc-map: "), result
        assert text in result.stderr, (text, result.stderr)
        assert self.out.read_bytes() == b"old", "the old map was touched"
        assert sorted(self.folder.rglob("*")) == before, set(self.folder.rglob("*")) ^ set(before)
        self.out.unlink()


def has_spot(summary, what, first, last):
    """A weak spot of that kind that touches the frames."""
    return any(what in spot["what"] and spot["first_frame"] <= last and spot["last_frame"] >= first and spot["advice"]
               for spot in summary["slam"]["weak_spots"])


def check_no_depth(bench):
    recording = bench.recording("no-depth", slice(0, 12))
    recording.save()
    (recording.folder / "depth.txt").unlink()
    bench.refused(2, "no depth images", recording.folder)
    for name, metres, text in (("constant", 2, "depth is the same everywhere"), ("covered", 0, "no feature has depth"),
                               ("too-near", 0.1, "")):
        recording = bench.recording(name, slice(0, 12))
        for _, path in recording.depth:
            recording.replace(path, constant_depth(metres))
        bench.refused(2, text, recording.save())


def check_standing_still(bench):
    recording = bench.recording("still", slice(0, 15))
    for lines in (recording.color, recording.depth):
        for line in lines[1:]:
            recording.replace(line[1], (recording.folder / lines[0][1]).read_bytes())
    bench.refused(2, "stood still", recording.save())


def check_stamp_jumps(bench):
    recording = bench.recording("jumps", slice(0, 40))
    for lines in (recording.color, recording.depth):
        for line in lines[20:]:
            line[0] = float(line[0]) + 60
    summary = bench.built(recording.save(), bench.out)
    assert summary["slam"]["stamp_jumps"] == 1 and has_spot(summary, "time jump", 20, 20), summary
    # Backwards is no recording.
    for lines in (recording.color, recording.depth):
        for line in lines[20:]:
            line[0] = float(line[0]) - 61
    bench.refused(2, "rgb.txt:21", recording.save())


def check_missing_images(bench):
    recording = bench.recording("missing", slice(0, 40))
    (recording.folder / recording.color[15][1]).unlink()
    bench.refused(2, recording.color[15][1], recording.save())

    recording = bench.recording("corrupt", slice(0, 40))
    recording.replace(recording.color[15][1], b"\xff\xd8\xff\xe0 torn")
    recording.replace(recording.depth[25][1], (recording.folder / recording.depth[25][1]).read_bytes()[:1000])
    summary = bench.built(recording.save(), bench.out, num_lines=1)
    assert summary["frames"]["broken"] == 2 and recording.color[15][1] in summary["stderr"], summary
    assert summary["frames"]["used"] == 38, summary

    recording = bench.recording("gaps", slice(0, 40))
    del recording.depth[10:14]
    summary = bench.built(recording.save(), bench.out)
    assert summary["frames"]["without_depth"] == 4 and summary["frames"]["used"] == 36, summary

    recording = bench.recording("all-torn", slice(0, 12))
    for _, path in recording.color:
        recording.replace(path, (recording.folder / path).read_bytes()[:4000])
    bench.refused(1, "none of 12 frames could be read", recording.save())
    recording = bench.recording("all-text", slice(0, 12))
    for _, path in recording.color:
        recording.replace(path, b"text")
    bench.refused(1, "neither a JPEG nor a PNG", recording.save())


def check_person(bench):
    """The camera waits while somebody walks by and hides everything for most of a second."""
    rng = random.Random(5)
    blocks = [[bytes([rng.randrange(256)]) * 12 for _ in range(120)] for _ in range(HEIGHT // 12)]
    rows = [b"".join(row) for row in blocks for _ in range(12)]
    recording = bench.recording("person", slice(0, 41))
    for lines in (recording.color, recording.depth):
        for line in lines[20:]:
            line[0] = float(line[0]) + 0.9
    for i in range(20, 29):
        name, stamp = f"person-{i}.png", float(recording.color[0][0]) + 0.1 * i
        shift = 40 * (i - 20)
        (recording.folder / "rgb" / name).write_bytes(png(8, [row[shift:shift + WIDTH] for row in rows]))
        (recording.folder / "depth" / name).write_bytes(
            png(16, [struct.pack(f">{WIDTH}H", *(5500 + (x + 20 * i) % 300 for x in range(WIDTH)))] * HEIGHT))
        recording.color.insert(i, [stamp, f"rgb/{name}"])
        recording.depth.insert(i, [stamp, f"depth/{name}"])
    summary = bench.built(recording.save(), bench.out)
    assert summary["slam"]["lost"] == 9 and summary["submaps"] == [] and has_spot(summary, "lost", 20, 28), summary
    assert summary["frames"]["used"] == 41, summary
    # The person is not in the map: it holds about as much as a map made without these frames.
    other = bench.built(bench.recording("nobody", slice(0, 41)).save(), bench.folder / "nobody.cmap")
    kept, expected = summary["landmarks"]["before"], other["landmarks"]["before"]
    assert abs(kept - expected) < 0.05 * expected, (kept, expected)


def check_output(bench):
    bench.refused(2, "does not exist", bench.walk, "--trajectory", str(bench.folder / "no" / "x.tum"))
    # No user, not even root, may write there.
    result = bench.run(*bench.arguments(bench.walk, "/proc/self/x.cmap"))
    assert result.returncode == 1 and len(result.stderr.splitlines()) == 1 and "/proc/self/x.cmap" in result.stderr, result


def start_until(bench, has_come):
    """A build of the walk in the background, and its log, as soon as `has_come(log)`."""
    log = pathlib.Path(f"{bench.out}.views")
    process = subprocess.Popen(bench.arguments(bench.walk, bench.out), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + PATIENCE_S
    while not log.exists() or not has_come(log):
        assert process.poll() is None and time.monotonic() < end, process.communicate()
        time.sleep(0.002)
    return process, log


def size_of_whole_log(bench):
    """A build removes its log at the end: what it has grown to is seen by a second name of the file."""
    process, log = start_until(bench, lambda log: True)
    kept = bench.folder / "kept.views"
    os.link(log, kept)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0 and not log.exists(), (out, err)
    size = kept.stat().st_size
    kept.unlink()
    return size


def check_interrupt(bench):
    process, log = start_until(bench, lambda log: log.stat().st_size > 4_000_000)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0 and err == "" and "--resume" in out, (out, err)
    assert log.exists() and bench.run(CAMLOC, "map", "verify", bench.out).returncode == 0
    partial = bench.out.read_bytes()
    assert partial != bench.map.read_bytes()
    size = log.stat().st_size

    # Not every log is this one's.
    other = bench.recording("other", slice(5, 30)).save()
    result = bench.run(*bench.arguments(other, bench.out, "--resume"))
    assert result.returncode == 2 and len(result.stderr.splitlines()) == 1 and "another recording" in result.stderr, result
    assert bench.out.read_bytes() == partial and log.stat().st_size == size

    # A crash in the middle of a record; then on to the end.
    with open(log, "r+b") as file:
        file.truncate(size - 12345)
    summary = bench.built(bench.walk, bench.out, "--resume")
    resumed = summary["slam"]["resumed_views"]
    assert 10 < resumed < bench.num_frames and not summary["is_partial"], summary
    assert bench.out.read_bytes() == bench.map.read_bytes(), "a resumed build made another map"
    assert not log.exists()
    bench.refused(2, "there is no interrupted build", bench.walk, "--resume")


def check_full_disk(bench):
    """Too small for the log; large enough for the log and not for the map as well."""
    log_bytes = size_of_whole_log(bench)
    disk = bench.folder / "disk"
    disk.mkdir()
    script = ('mount -t tmpfs -o size="$1" none "$0" || exit 77; printf old > "$0/m.cmap"; shift; "$@"; code=$?; '
              'test "$(cat "$0/m.cmap")" = old || exit 99; ls "$0" | grep -qvx "m.cmap\\|m.cmap.views" && exit 98; exit $code')
    for size in (1_000_000, log_bytes + bench.map.stat().st_size // 2):
        command = ["unshare", "-m" if os.geteuid() == 0 else "-rm", "sh", "-c", script, str(disk), str(size)]
        result = bench.run(*command, *bench.arguments(bench.walk, disk / "m.cmap"))
        if result.returncode == 77 or "unshare" in result.stderr:
            print("a full disk was not tried: mounting is not permitted here")
            return
        assert result.returncode == 1 and len(result.stderr.splitlines()) == 1 and "No space left" in result.stderr, result


if not CAMLOC_SIM:
    print("skipped: camloc-sim is not built, it makes the recording")
    sys.exit(77)
with contextlib.ExitStack() as stack:
    top = pathlib.Path(tempfile.mkdtemp(prefix="camloc-bad-walks-"))
    stack.callback(shutil.rmtree, top, ignore_errors=True)
    bench = Bench(top)
    for check in (check_no_depth, check_standing_still, check_stamp_jumps, check_missing_images, check_person, check_output,
                  check_interrupt, check_full_disk):
        check(bench)
print("passed")
