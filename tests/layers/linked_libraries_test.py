#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""What camlocd loads at start: none of the libraries that would make it big and slow. Usage: linked_libraries_test.py PROGRAM"""
import re
import subprocess
import sys

# OpenCV's codecs alone pull in GDAL: 62 MB resident instead of 11.
FORBIDDEN = re.compile(r"^lib(opencv_(imgcodecs|highgui|videoio|dnn|contrib|stitching)|gdal|Qt5|gtk|ceres|python3)")


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    listing = subprocess.run(["ldd", sys.argv[1]], check=True, capture_output=True, text=True).stdout
    libraries = [line.split()[0] for line in listing.splitlines() if line.strip()]
    if not any(name.startswith("libc.so") for name in libraries):
        print(f"ldd says nothing of use about {sys.argv[1]}:\n{listing}")
        return 1
    found = [name for name in libraries if FORBIDDEN.match(name)]
    print(f"{len(libraries)} libraries, forbidden: {' '.join(found) or 'none'}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
