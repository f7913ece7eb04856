#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Every configuration mistake is one line on stderr with file and line, exit code 2; a right one prints OK."""
import subprocess

from scenario import CAMLOCD, SAMPLE, scenario

CASES = [
    ("[localise]\n", ":1: [localise]: unknown section"),
    ("\n[localize]\nfeature = 1\n", ":3: localize.feature: unknown key"),
    ("[localize]\nfeatures = 'many'\n", ":2: localize.features: wants a whole number"),
    ("[localize]\nfeatures = 1000000\n", ":2: localize.features: 1000000 is out of range, 100 to 4000"),
    ("[localize]\ntracking = 1\n", ":2: localize.tracking: wants true or false"),
    ("[publish]\nframe = 'mars'\n", ":2: publish.frame: 'mars' is not one of map|wcs"),
    ("[map\n", "camlocd.toml:"),
    ("[source]\nurl = 'telepathy://'\n", "no 'telepathy' source"),
    ("[source]\nurl = 'replay:///nowhere'\n", "/nowhere"),
    ("[source]\nurl = 'sample://?width=320&height=240'\ncamera = '/nowhere.toml'\n", "source.camera: "),
]


def check(*arguments):
    return subprocess.run([CAMLOCD, *arguments], capture_output=True, text=True, timeout=30)


def assert_refused(result, text):
    assert result.returncode == 2, result
    assert result.stdout == "" and len(result.stderr.splitlines()) == 1, result
    assert result.stderr.startswith("camlocd: ") and text in result.stderr, result


with scenario() as (folder, _, _):
    config = folder / "camlocd.toml"
    for content, text in CASES:
        config.write_text(content)
        assert_refused(check("--config", str(config), "--check-config"), text)
    config.write_text(f"[source]\nurl = '{SAMPLE}'\n")
    good = check("--config", str(config), "--check-config")
    assert (good.returncode, good.stdout, good.stderr) == (0, "OK\n", ""), good
    for setting in ("x", "a.b=c", "localize.features=x", "localize.features=1", "source.url=telepathy://"):
        assert_refused(check("--config", str(config), "--check-config", "--set", setting), "")
    assert_refused(check("--config", str(folder / "none.toml")), "none.toml")
    assert_refused(check("--config", str(config), "--set", "log.level=loud"), "log.level")
    assert check("--nonsense").returncode == 2
    assert check("--help").returncode == 0 and "Examples:" in check("--help").stdout
    assert check("--version").stdout.startswith("camlocd ")

    # The camera's image size does not match the source: found by the check, and by the daemon itself.
    camera = folder / "camera.toml"
    size = check("--config", str(config), "--check-config", "--set", f"source.camera={camera}")
    assert_refused(size, "camera.toml")

    printed = check("--config", str(config), "--print-config")
    config.write_text(printed.stdout)
    assert check("--config", str(config), "--print-config").stdout == printed.stdout
    (folder / "camlocd.toml.d").mkdir()
    (folder / "camlocd.toml.d" / "10.toml").write_text("[localize]\nfeatures = 333\n")
    assert "features = 333" in check("--config", str(config), "--print-config").stdout
    assert "features = 444" in check("--config", str(config), "--set", "localize.features=444", "--print-config").stdout
