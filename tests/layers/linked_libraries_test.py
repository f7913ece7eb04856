#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""What the programs of the device load at start: none of the libraries that would make it big and slow.

Usage: linked_libraries_test.py PROGRAM...
"""
import re
import subprocess
import sys

# OpenCV's smallest library comes with Mesa, LLVM and X11: 230 MB on the disk; its codecs with GDAL: 62 MB resident instead of 11.
FORBIDDEN = re.compile(r"^lib(opencv|gdal|Qt5|gtk|X11|GL|tbb|ceres|python3)")


def check(program):
    """Whether it is well; prints what was found."""
    listing = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    libraries = [line.split()[0] for line in listing.splitlines() if line.strip()]
    if not any(name.startswith("libc.so") for name in libraries):
        print(f"ldd says nothing of use about {program}:\n{listing}")
        return False
    found = [name for name in libraries if FORBIDDEN.match(name)]
    print(f"{program}: {len(libraries)} libraries, forbidden: {' '.join(found) or 'none'}")
    return not found


def main():
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    return 0 if all([check(program) for program in sys.argv[1:]]) else 1


if __name__ == "__main__":
    sys.exit(main())
