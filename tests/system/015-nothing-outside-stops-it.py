#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Named pipes in the place of files, silent clients and limits of the system cost what they must, in one line, and no more."""
import os
import resource
import signal
import socket
import subprocess
import time

from scenario import CAMLOCD, SAMPLE, add_route, make_map, scenario, wait_until


def run(*arguments, limits=None):
    """Ends by itself, soon."""
    def set_limits():
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for which, value in (limits or {}).items():
            resource.setrlimit(which, (value, value))
    return subprocess.run([CAMLOCD, *map(str, arguments)], capture_output=True, text=True, timeout=20, preexec_fn=set_limits)


def assert_one_line(result, code, text):
    assert result.returncode == code and len(result.stderr.splitlines()) == 1 and text in result.stderr, result


def pipes_at_start(folder):
    pipe = folder / "pipe.toml"
    os.mkfifo(pipe)
    assert_one_line(run("--config", pipe, "--check-config"), 2, "not a regular file")
    config = folder / "start.toml"
    config.write_text("")
    (folder / "start.toml.d").mkdir()
    os.mkfifo(folder / "start.toml.d/x.toml")
    assert_one_line(run("--config", config, "--check-config"), 2, "start.toml.d/x.toml: is not a regular file")
    (folder / "start.toml.d/x.toml").unlink()
    settings = ["--config", config, "--set", f"source.url={SAMPLE}", "--set", f"control.socket={folder}/s"]
    assert_one_line(run(*settings, "--set", f"source.camera={pipe}"), 2, "not a regular file")
    walk = folder / "walk"
    walk.mkdir()
    os.mkfifo(walk / "rgb.txt")
    assert_one_line(run("--config", config, "--set", f"source.url=replay://{walk}", "--check-config"), 2, "walk")
    (walk / "rgb.txt").unlink()
    os.mkfifo(walk / "a.png")
    (walk / "rgb.txt").write_text("1.0 a.png\n")
    assert_one_line(run("--config", config, "--set", f"source.url=replay://{walk}", "--check-config"), 2, "a.png")
    return settings


def pipes_at_reload(folder, daemon):
    drop_ins = folder / "camlocd.toml.d"
    drop_ins.mkdir()
    os.mkfifo(drop_ins / "x.toml")
    assert "not a regular file" in daemon.command("reload")["error"]
    (drop_ins / "x.toml").unlink()
    (folder / "map.cmap").rename(folder / "aside")
    os.mkfifo(folder / "map.cmap")
    assert "no regular file" in daemon.command("reload")["error"]
    (folder / "map.cmap").unlink()
    (folder / "aside").rename(folder / "map.cmap")
    assert daemon.command("reload") == {"ok": True}


def silent_clients(daemon):
    silent = []
    for _ in range(12):
        client = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        client.setblocking(False)
        try:
            client.connect(str(daemon.socket))
        except BlockingIOError:
            continue
        silent.append(client)
    assert len(silent) > 8
    begin = time.monotonic()

    def is_answered():
        try:
            return daemon.command("status")
        except BlockingIOError:  # the queue before the listener is full, too
            return None

    wait_until(is_answered, "an answer")
    assert time.monotonic() - begin < 1.5, "others wait for silent clients"  # 2 s is the patience with one


def limits(folder, settings):
    assert_one_line(run(*settings, limits={resource.RLIMIT_NOFILE: 12}), 1, "at most 12 files may be open, 64 are needed")
    for megabytes in (20, 24, 28):  # what is enough runs until it is stopped; what is not says so
        try:
            result = run(*settings, limits={resource.RLIMIT_AS: megabytes << 20})
        except subprocess.TimeoutExpired:
            break
        assert result.returncode in (1, 127), result  # 127: the loader itself
        assert len(result.stderr.splitlines()) >= 1 and "terminate called" not in result.stderr, result


with scenario() as (folder, start, tap):
    add_route()
    make_map(folder / "map.cmap")
    settings = pipes_at_start(folder)
    daemon = start().wait_started()
    daemon.wait_state("LOCALIZED")
    pipes_at_reload(folder, daemon)
    silent_clients(daemon)
    assert daemon.stop() == 0

    # A log file at its limit of size.
    with open(folder / "log", "wb") as log:
        daemon = start(stderr=log)
        wait_until(daemon.socket.exists, "control socket")
        resource.prlimit(daemon.process.pid, resource.RLIMIT_FSIZE, (100, 100))
        daemon.wait_state("LOCALIZED")
        assert daemon.command("reload") == {"ok": True}
        assert wait_until(lambda: daemon.command("status")["log_lines_lost"], "lines lost") > 0
    daemon.signal(signal.SIGTERM)
    assert daemon.wait() == 0

    # A soft limit is no limit.
    daemon = start(shell="ulimit -S -n 12").wait_started()
    daemon.wait_state("LOCALIZED")
    assert daemon.stop() == 0
    # As a log of LCM a named pipe would wait for its reader.
    os.mkfifo(folder / "poses.lcm")
    daemon = start(publish__lcm_url=f"file://{folder}/poses.lcm?mode=w").wait_started()
    daemon.wait_state("LOCALIZED")
    assert daemon.stop() == 0
    limits(folder, settings)
