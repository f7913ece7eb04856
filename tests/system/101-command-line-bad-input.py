#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever is wrong with what camloc, camloc-map and camloc-bench are given ends in one line on stderr that names the object,
exit code 1 (failed) or 2 (usage, configuration), and leaves no partial file; frames that only show nothing are no error."""
import contextlib
import os
import pathlib
import random
import resource
import shutil
import struct
import subprocess
import tempfile
import zlib

CAMLOC = os.environ["CAMLOC"]
CAMLOC_MAP = os.environ["CAMLOC_MAP"]
CAMLOC_BENCH = os.environ["CAMLOC_BENCH"]
WIDTH, HEIGHT, NUM_FRAMES = 320, 240, 6
RANDOM = random.Random(7)

CAMERA = """name = "generated"
[color]
width = {width}
height = {height}
fx = 262.5
fy = 262.5
cx = 160.0
cy = {cy}
[depth]
registered = true
unit_m = 0.001
"""


def png(width, height, bits, rows):
    """Bytes of a grey PNG; `rows` holds width * bits / 8 bytes for each row."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows), 1)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def flat(value, width=WIDTH, height=HEIGHT):
    return png(width, height, 8, [bytes([value]) * width] * height)


def noise(width=WIDTH, height=HEIGHT):
    return png(width, height, 8, [RANDOM.randbytes(width) for _ in range(height)])


def depth(value_mm, width=WIDTH, height=HEIGHT):
    return png(width, height, 16, [struct.pack(">H", value_mm) * width] * height)


def blocks():
    """Grey squares of two sizes: corners that a map can be made of."""
    coarse = [[RANDOM.randrange(256) for _ in range(WIDTH // 10)] for _ in range(HEIGHT // 10)]
    fine = [[RANDOM.randrange(-40, 40) for _ in range(WIDTH // 4)] for _ in range(HEIGHT // 4)]
    return png(WIDTH, HEIGHT, 8, [bytes(max(0, min(255, coarse[y // 10][x // 10] + fine[y // 4][x // 4])) for x in range(WIDTH))
                                  for y in range(HEIGHT)])


def make_sequence(folder, color, depth_image, num_frames=NUM_FRAMES):
    """TUM layout; every frame is the same and taken from the same place."""
    for name in ("rgb", "depth"):
        (folder / name).mkdir(parents=True)
    for i in range(num_frames):
        (folder / "rgb" / f"{i}.png").write_bytes(color)
        (folder / "depth" / f"{i}.png").write_bytes(depth_image)
    for name in ("rgb", "depth"):
        (folder / f"{name}.txt").write_text("".join(f"{i + 1}.0 {name}/{i}.png\n" for i in range(num_frames)))
    (folder / "groundtruth.txt").write_text("".join(f"{i + 1}.0 0 0 0 0 0 0 1\n" for i in range(num_frames)))
    return folder


class Bench:
    """A folder with a good map, camera and sequence, and the programs."""

    def __init__(self, folder):
        self.folder = folder
        self.camera = folder / "camera.toml"
        self.camera.write_text(CAMERA.format(width=WIDTH, height=HEIGHT, cy=HEIGHT / 2))
        self.sequence = make_sequence(folder / "good", blocks(), depth(2000))
        self.map = folder / "good.cmap"
        self.out = folder / "out.tum"
        built = self.run(*self.build_arguments(self.sequence, self.map))
        assert built.returncode == 0, built
        self.bytes = self.map.read_bytes()
        localized = self.run(*self.localize_arguments())
        assert localized.returncode == 0 and self.out.exists() and localized.stderr == "", localized
        self.out.unlink()

    def build_arguments(self, sequence, out, *more, camera=None):
        return [CAMLOC_MAP, "build", "--sequence", str(sequence), "--camera", str(camera or self.camera), "--poses", "embedded",
                "--out", str(out), *more]

    def localize_arguments(self, *more, map=None, sequence=None, camera=None):
        return [CAMLOC, "localize", "--map", str(map or self.map), "--sequence", str(sequence or self.sequence),
                "--camera", str(camera or self.camera), "--out", str(self.out), *more]

    def bench_arguments(self, *more, map=None, sequence=None, camera=None):
        return [CAMLOC_BENCH, "--map", str(map or self.map), "--sequence", str(sequence or self.sequence),
                "--camera", str(camera or self.camera), *more]

    def slam_arguments(self, *more):
        return [CAMLOC_BENCH, "slam", "--sequence", str(self.sequence), "--camera", str(self.camera), *more]

    def run(self, *arguments, **more):
        return subprocess.run(arguments, capture_output=True, text=True, timeout=60, **more)

    def refused(self, arguments, text, codes=(1, 2), **more):
        """One line that holds `text`; nothing new in the folder."""
        before = sorted(self.folder.rglob("*"))
        result = self.run(*[str(argument) for argument in arguments], **more)
        assert result.returncode in codes, result
        assert len(result.stderr.splitlines()) == 1 and result.stderr.startswith("camloc"), result
        assert text in result.stderr and result.stdout == "", (text, result)
        assert sorted(self.folder.rglob("*")) == before, (set(self.folder.rglob("*")) - set(before), result)
        return result


def check_map_files(bench):
    bad = bench.folder / "bad.cmap"

    def refuse(path, text, is_everywhere=False):
        bench.refused([CAMLOC, "map", "verify", path], text, codes=(1,))
        if is_everywhere:
            bench.refused([CAMLOC, "map", "info", path], text, codes=(1,))
            bench.refused(bench.localize_arguments(map=path), text, codes=(1,))
            bench.refused(bench.bench_arguments(map=path), text, codes=(1,))

    refuse(bench.folder / "none.cmap", "none.cmap", True)
    refuse(bench.folder, str(bench.folder), True)
    bad.write_bytes(b"")
    refuse(bad, "bad.cmap", True)
    # For root no permission is missing; a file of /proc that can be opened and not read stands for it.
    bad.chmod(0)
    refuse("/proc/self/mem" if os.geteuid() == 0 else bad, "mem" if os.geteuid() == 0 else "bad.cmap", True)
    bad.chmod(0o644)

    size = len(bench.bytes)
    for length in [1, 7, 8, 63, 64, 65, 100, 415, 416, 448, size // 2, size - 64, size - 1] + [RANDOM.randrange(size) for _ in range(12)]:
        bad.write_bytes(bench.bytes[:length])
        refuse(bad, "bad.cmap", length == 64)
    bad.write_bytes(bench.bytes + b"\0")
    refuse(bad, "bad.cmap")
    for at in [*range(0, 64, 3), *range(64, 448, 29), *[RANDOM.randrange(448, size) for _ in range(40)]]:
        damaged = bytearray(bench.bytes)
        damaged[at] ^= 1 << RANDOM.randrange(8)
        bad.write_bytes(damaged)
        refuse(bad, "bad.cmap")
    # Version and byte order are covered by a hash; a writer of another kind would have got it right, a tamperer not.
    for at, value in ((12, struct.pack("<I", 99)), (8, struct.pack(">I", 0x01020304))):
        bad.write_bytes(bench.bytes[:at] + value + bench.bytes[at + 4:])
        refuse(bad, "bad.cmap", True)
    bad.unlink()


def check_cameras(bench):
    camera = bench.folder / "other.toml"
    for content, text in [(CAMERA.format(width=640, height=480, cy=240), "320x240"), ("", "other.toml"), ("[color\n", "other.toml"),
                          (CAMERA.format(width=-3, height=240, cy=120), "other.toml"), ("\0\1\2", "other.toml")]:
        camera.write_text(content)
        bench.refused(bench.localize_arguments(camera=camera), text)
        bench.refused(bench.bench_arguments(camera=camera), text)
        bench.refused(bench.build_arguments(bench.sequence, bench.folder / "x.cmap", camera=camera), text)
    for path in (bench.folder / "none.toml", bench.folder):
        bench.refused(bench.localize_arguments(camera=path), str(path))
        bench.refused(bench.build_arguments(bench.sequence, bench.folder / "x.cmap", camera=path), str(path))
    camera.unlink()


def refuse_sequence(bench, sequence, text):
    bench.refused(bench.localize_arguments(sequence=sequence), text)
    bench.refused(bench.bench_arguments(sequence=sequence), text)
    bench.refused(bench.build_arguments(sequence, bench.folder / "x.cmap"), text)


def check_sequences(bench):
    refuse_sequence(bench, bench.folder / "nowhere", "nowhere")
    refuse_sequence(bench, bench.map, "good.cmap")
    refuse_sequence(bench, "telepathy://x", "telepathy")
    (bench.folder / "hollow").mkdir()
    refuse_sequence(bench, bench.folder / "hollow", "hollow")

    missing = make_sequence(bench.folder / "missing", blocks(), depth(2000))
    (missing / "rgb" / "3.png").unlink()
    refuse_sequence(bench, missing, "rgb/3.png")
    unsorted = make_sequence(bench.folder / "unsorted", blocks(), depth(2000))
    lines = (unsorted / "rgb.txt").read_text().splitlines()
    (unsorted / "rgb.txt").write_text("\n".join([lines[1], lines[0], *lines[2:]]) + "\n")
    refuse_sequence(bench, unsorted, "rgb.txt:2")

    good = blocks()
    for name, color, depth_image in [("torn", good[: len(good) // 2], depth(2000)), ("text", b"hello", depth(2000)), ("nothing", b"", depth(2000)),
                                     ("jpeg", b"\xff\xd8\xff\xe0\0\x10JFIF", depth(2000)), ("torn-depth", good, depth(2000)[:60]),
                                     ("8-bit-depth", good, flat(9)), ("other-size", noise(32, 24), depth(2000))]:
        refuse_sequence(bench, make_sequence(bench.folder / name, color, depth_image), "")


def check_one_broken_frame(bench):
    """It is left out and named; the others count."""
    sequence = make_sequence(bench.folder / "one-broken", (bench.sequence / "rgb" / "0.png").read_bytes(), depth(2000))
    (sequence / "rgb" / "2.png").write_bytes(b"broken")
    for arguments in (bench.localize_arguments(sequence=sequence), bench.build_arguments(sequence, bench.folder / "y.cmap"),
                      bench.bench_arguments(sequence=sequence)):
        result = bench.run(*arguments)
        assert result.returncode == 0 and len(result.stderr.splitlines()) == 1, result
        assert f"1 of {NUM_FRAMES} frames" in result.stderr and "rgb/2.png" in result.stderr, result
    (bench.folder / "y.cmap").unlink()
    bench.out.unlink()


def check_frames_that_show_nothing(bench):
    line_camera = bench.folder / "line.toml"
    line_camera.write_text(CAMERA.format(width=WIDTH, height=1, cy=0))
    good = (bench.sequence / "rgb" / "0.png").read_bytes()
    for name, color, depth_image, camera in [("black", flat(0), depth(2000), None), ("white", flat(255), depth(2000), None),
                                             ("noise", noise(), depth(2000), None), ("no-depth", good, depth(0), None),
                                             ("far-depth", flat(128), depth(65535), None),
                                             ("line", noise(WIDTH, 1), depth(2000, WIDTH, 1), line_camera)]:
        sequence = make_sequence(bench.folder / name, color, depth_image)
        for mode in ("track", "single"):
            result = bench.run(*bench.localize_arguments("--mode", mode, sequence=sequence, camera=camera))
            if result.returncode != 0:  # a camera of one line may be refused, with its name
                assert name == "line" and result.returncode in (1, 2) and len(result.stderr.splitlines()) == 1, result
                assert "line.toml" in result.stderr, result
                continue
            assert result.stderr == "", result
            assert name == "no-depth" or "LOCALIZED" not in result.stdout, (name, result)
            bench.out.unlink()
        if name != "no-depth":
            continue
        bench.refused(bench.build_arguments(sequence, bench.folder / "x.cmap"), "")


def check_usage(bench):
    for frames in ("a:b", "::0", "1:2:3:4", "1&loop=1", "900:", "0x3", "1e3", "99999999999999999999", ","):
        bench.refused(bench.localize_arguments("--frames", frames), "", codes=(2,))
        bench.refused(bench.bench_arguments("--frames", frames), "", codes=(2,))
        bench.refused(bench.build_arguments(bench.sequence, bench.folder / "x.cmap", "--frames", frames), "", codes=(2,))
    for perturb in ("gama=1", "gamma", "gamma=", "gamma=x", "gamma=nan", "gamma=-1", "noise=1e9", "blur=0", "="):
        bench.refused(bench.localize_arguments("--perturb", perturb), f"--perturb {perturb}", codes=(2,))
    for arguments, text in [([CAMLOC], "camloc --help"), ([CAMLOC, "localise"], "did you mean 'localize'"),
                            ([CAMLOC, "map", "inf"], "did you mean 'map info'"), ([CAMLOC, "--bogus"], "camloc --help"),
                            ([CAMLOC, "eval"], "--estimate"), ([CAMLOC, "li\nne"], "li?ne"), ([CAMLOC_MAP], "camloc-map --help"),
                            ([CAMLOC_MAP, "build", "--bogus"], "camloc-map build --help"), ([CAMLOC_BENCH], "camloc bench --help"),
                            ([CAMLOC_BENCH, "slam"], "camloc bench slam --help"),
                            (bench.slam_arguments("--set", "slam.bogus=1"), "bogus: no such number"),
                            (bench.slam_arguments("--set", "bogus=1"), "give slam.NAME=VALUE"),
                            (bench.slam_arguments("--set", "slam.close_loops=maybe"), "close_loops=maybe"),
                            (bench.bench_arguments("--repeat", "0"), "--repeat"), (bench.localize_arguments("--mode", "fly"), "--mode"),
                            (bench.localize_arguments("--bogus"), "--bogus"), (bench.localize_arguments("extra"), "extra"),
                            (bench.localize_arguments("--json", str(bench.folder / "no" / "x.json")), "--json"),
                            (bench.build_arguments(bench.sequence, bench.folder), "is a folder"),
                            (bench.build_arguments(bench.sequence, bench.folder / "no" / "x.cmap"), "does not exist"),
                            (bench.build_arguments(bench.sequence, bench.folder / "x.cmap", "--max-bytes", "lots"), "--max-bytes")]:
        bench.refused(arguments, text, codes=(2,))
    for program in ([CAMLOC], [CAMLOC, "localize"], [CAMLOC, "map", "build"], [CAMLOC, "bench"]):
        result = bench.run(*program, "--help")
        assert result.returncode == 0 and result.stderr == "" and "Usage" in result.stdout, result


def check_trajectories(bench):
    bad = bench.folder / "bad.tum"
    reference = str(bench.sequence)
    for content, text in [("1 2 3\n", "bad.tum:1"), ("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "bad.tum:2"), ("\0\0", "bad.tum"),
                          ("# covariance 1 2\n1 0 0 0 0 0 0 1\n", "bad.tum:1"), ("99 0 0 0 0 0 0 1\n", "bad.tum")]:
        bad.write_text(content)
        bench.refused([CAMLOC, "eval", "--estimate", bad, "--reference", reference], text)
    good = bench.folder / "good.tum"
    good.write_text("1 0 0 0 0 0 0 1\n")
    for more in (["--reference", bad], ["--reference", bench.folder / "none"], ["--reference", reference, "--png", bench.folder / "x.png", "--map", bad],
                 ["--reference", reference, "--png", bench.folder / "no" / "x.png"]):
        bench.refused([CAMLOC, "eval", "--estimate", good, *more], str(more[-1]))
    bench.refused([CAMLOC, "eval", "--estimate", bench.folder / "none.tum", "--reference", reference], "none.tum")


def check_full_disk(bench):
    """The old files stay. A disk of its own where that is permitted, a limit on the size of files where not."""
    old = bench.map.read_bytes()

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    # restore_signals=False keeps SIGXFSZ ignored, so that the write fails as it does on a full disk.
    bench.refused(bench.build_arguments(bench.sequence, bench.map), "good.cmap", codes=(1,), preexec_fn=limit, restore_signals=False)
    assert bench.map.read_bytes() == old

    disk = bench.folder / "disk"
    disk.mkdir()
    script = ('mount -t tmpfs -o size=16k none "$0" || exit 77; printf old > "$0/m.cmap"; "$@"; code=$?; '
              'test "$(cat "$0/m.cmap")" = old && test "$(ls "$0")" = m.cmap || exit 99; exit $code')
    command = ["unshare", "-m" if os.geteuid() == 0 else "-rm", "sh", "-c", script, str(disk)]
    result = bench.run(*command, *bench.build_arguments(bench.sequence, disk / "m.cmap"))
    if result.returncode == 77 or "unshare" in result.stderr:
        print("a full disk was not tried: mounting is not permitted here")
        return
    assert result.returncode == 1 and len(result.stderr.splitlines()) == 1 and "No space left" in result.stderr, result


with contextlib.ExitStack() as stack:
    top = pathlib.Path(tempfile.mkdtemp(prefix="camloc-bad-input-"))
    stack.callback(shutil.rmtree, top, ignore_errors=True)
    bench = Bench(top)
    for check in (check_usage, check_map_files, check_cameras, check_trajectories, check_sequences, check_one_broken_frame,
                  check_frames_that_show_nothing, check_full_disk):
        check(bench)
