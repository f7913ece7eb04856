#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Runs a scenario in a network namespace of its own: LCM multicast reaches nobody else, and routes can come and go.

Usage: in_namespace.py SCENARIO. Exit code 77 (skipped) where namespaces are not permitted.
"""
import os
import shutil
import subprocess
import sys

# As root a plain namespace; else one with a user namespace, where the caller is root inside.
COMMANDS = (["unshare", "-n"], ["unshare", "-r", "-n"])
SETUP = "ip link set lo up && exec \"$@\""


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if shutil.which("ip") is None or shutil.which("unshare") is None:
        print("skipped: needs ip (iproute2) and unshare (util-linux)")
        return 77
    for command in COMMANDS:
        if subprocess.run(command + ["ip", "link", "set", "lo", "up"], capture_output=True).returncode == 0:
            environment = dict(os.environ, PYTHONDONTWRITEBYTECODE="1")
            return subprocess.run(command + ["sh", "-c", SETUP, "sh", sys.executable, sys.argv[1]], env=environment).returncode
    print("skipped: network namespaces are not permitted here")
    return 77


if __name__ == "__main__":
    sys.exit(main())
