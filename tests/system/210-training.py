#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""camloc train on a generated walk: it writes a model, curves and nothing else; interrupted and resumed it makes the same bytes as in one
go; and what is wrong with what it is given ends in one line, the documented exit code and the model of before."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

CAMLOC_MAP = os.environ["CAMLOC_MAP"]
CAMLOC_SIM = os.environ.get("CAMLOC_SIM", "")
CAMLOC_TRAIN = os.environ.get("CAMLOC_TRAIN", "")
PATIENCE_S = 180

if not CAMLOC_SIM or not CAMLOC_TRAIN:
    print("skipped: camloc-sim or camloc-train is not built (libtorch-dev is missing)")
    sys.exit(77)


def run(*arguments):
    return subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True, timeout=PATIENCE_S)


class Bench:
    def __init__(self, folder):
        self.folder = folder
        made = run(CAMLOC_SIM, "--scene", "small", "--only", "mapping", "--duration-scale", "0.2", "--out", folder / "sim")
        assert made.returncode == 0, made
        self.walk, self.camera, self.map = folder / "sim" / "mapping", folder / "sim" / "camera.toml", folder / "m.cmap"
        made = run(CAMLOC_MAP, "build", "--sequence", self.walk, "--camera", self.camera, "--poses", "embedded", "--out", self.map)
        assert made.returncode == 0, made

    def arguments(self, out, *more):
        return [CAMLOC_TRAIN, "--map", self.map, "--sequence", self.walk, "--camera", self.camera, "--out", out, "--threads", "1", *more]

    def refused(self, code, text, *more, out=None):
        """One line that holds `text`, and the model of before."""
        out = out or self.folder / "old.onnx"
        old = out.parent.is_dir() and not out.is_dir()
        if old:
            out.write_bytes(b"old")
        result = run(*self.arguments(out, *more))
        assert result.returncode == code and result.stdout == "", result
        assert len(result.stderr.splitlines()) == 1 and result.stderr.startswith("camloc"), result
        assert text in result.stderr, (text, result.stderr)
        assert not old or out.read_bytes() == b"old", "the old model was touched"


def check_whole(bench):
    out = bench.folder / "whole.onnx"
    result = run(*bench.arguments(out, "--epochs", "4", "--json"))
    assert result.returncode == 0 and result.stderr == "", result
    summary = json.loads(result.stdout)
    assert summary["epochs"] == 4 and 1 <= summary["best_epoch"] <= 4, summary
    assert summary["frames"]["shown"] > 5 * summary["frames"]["held_out"] > 0, summary
    assert 0 < summary["held_out"]["translation_m"]["median"] < 5, summary
    assert out.stat().st_size > 500_000
    if "CAMLOC_NETWORK_PLUGIN" in os.environ:
        assert summary["device_difference"] < 1e-4, summary
    assert (bench.folder / "whole.png").read_bytes().startswith(b"\x89PNG")
    assert not (bench.folder / "whole.onnx.checkpoint").exists()
    return out


def check_interrupt(bench, whole):
    out = bench.folder / "parted.onnx"
    checkpoint = pathlib.Path(f"{out}.checkpoint")
    process = subprocess.Popen([str(a) for a in bench.arguments(out, "--epochs", "4")], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + PATIENCE_S
    while not checkpoint.exists():
        assert process.poll() is None and time.monotonic() < end, process.communicate()
        time.sleep(0.002)
    process.send_signal(signal.SIGINT)
    printed, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0 and err == "" and "--resume" in printed, (printed, err)
    assert out.stat().st_size > 500_000 and checkpoint.exists()

    bench.refused(2, "another training", "--epochs", "5", "--resume", out=out)
    result = run(*bench.arguments(out, "--epochs", "4", "--resume"))
    assert result.returncode == 0, result
    assert out.read_bytes() == whole.read_bytes(), "a resumed training made another model"
    assert not checkpoint.exists()


def check_bad_input(bench, whole):
    bench.refused(2, "too few to learn from", "--frames", "0:5")
    bench.refused(2, "--held-out", "--held-out", "0:100000")
    bench.refused(2, "--freeze", "--freeze")
    bench.refused(2, "once for all", *["--poses", "embedded"] * 2, "--sequence", bench.walk, "--sequence", bench.walk)
    bench.refused(1, "no.onnx", "--net", "squeezenet", "--init", bench.folder / "no.onnx")
    bench.refused(2, "conv", "--net", "squeezenet", "--init", whole)
    (bench.folder / "torn.onnx").write_bytes(whole.read_bytes()[:200_000])
    bench.refused(1, "torn.onnx", "--net", "squeezenet", "--init", bench.folder / "torn.onnx")
    bench.refused(1, ".checkpoint", "--resume")
    bench.refused(2, "does not exist", out=bench.folder / "no" / "x.onnx")
    bench.refused(1, "no.tum", "--poses", bench.folder / "no.tum")


folder = pathlib.Path(tempfile.mkdtemp(prefix="camloc-training-"))
try:
    bench = Bench(folder)
    whole = check_whole(bench)
    check_interrupt(bench, whole)
    check_bad_input(bench, whole)
finally:
    shutil.rmtree(folder, ignore_errors=True)
print("passed")
