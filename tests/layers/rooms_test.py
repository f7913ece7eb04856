#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""What keeps the tree readable, checked on all of it. Usage: rooms_test.py ROOT

No folder holds more than 25 .cc files, no file more than 500 lines. The files of a module (a .h with its .cc) and another module
do not include each other, directly or in a circle. Every .cc file of core, daemon, tools/mapping and tools/training has a test of its name in the
tests of its room, at any depth (core/slam/loops/x.cc: tests/slam/x_test.cc), or a line "x.cc: why not" in the room's untested.txt.
"""
import pathlib
import re
import sys
import tempfile
import unittest

MOST_SOURCES, MOST_LINES = 25, 500
TOPS = ("core", "plugins", "drivers", "daemon", "tools", "tests")
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)\.h"', re.MULTILINE)
# A module and the private half of it, which no other file includes.
KNOWN_CIRCLES = [{"core/features/hamming", "core/features/hamming_kernels"}]


def files_of(root, suffixes, tops=TOPS):
    return [file for top in tops for file in sorted((root / top).rglob("*")) if file.suffix in suffixes]


def circles(modules):
    """Sets of modules of which each includes, over others perhaps, all others (strongly connected, Tarjan 1972)."""
    index, low, path, found = {}, {}, [], []

    def visit(module):
        index[module] = low[module] = len(index)
        path.append(module)
        for other in modules[module]:
            if other not in index:
                visit(other)
            if other in path:
                low[module] = min(low[module], low[other])
        if low[module] == index[module]:
            circle = set(path[path.index(module):])
            del path[path.index(module):]
            if len(circle) > 1:
                found.append(circle)

    for module in modules:
        if module not in index:
            visit(module)
    return found


def circle_breaches(root):
    modules = {}
    for file in files_of(root, (".h", ".cc")):
        name = file.relative_to(root).with_suffix("").as_posix()
        modules.setdefault(name, set()).update(INCLUDE.findall(file.read_text()))
    modules = {name: {other for other in others if other in modules and other != name} for name, others in modules.items()}
    return [f"{' '.join(sorted(circle))}: include each other" for circle in circles(modules)
            if not any(circle <= known for known in KNOWN_CIRCLES)]


def size_breaches(root):
    found, num_sources = [], {}
    for file in files_of(root, (".h", ".cc", ".py", ".sh")):
        num_lines = file.read_text().count("\n")
        if num_lines > MOST_LINES:
            found.append(f"{file.relative_to(root)}: {num_lines} lines; {MOST_LINES} are the most")
        if file.suffix == ".cc":
            num_sources[file.parent] = num_sources.get(file.parent, 0) + 1
    return found + [f"{folder.relative_to(root)}: {number} .cc files; {MOST_SOURCES} are the most of a folder"
                    for folder, number in num_sources.items() if number > MOST_SOURCES]


def rooms(root):
    """Folders with code and the folder of their tests."""
    core = [folder for folder in sorted((root / "core").glob("*")) if folder.is_dir()]
    return [(room, root / "tests" / room.name) for room in [*core, root / "daemon", root / "tools" / "mapping", root / "tools" / "training"]]


def untested(root):
    """Sources with neither a test of their name nor a reason; and lines of untested.txt that are no longer true."""
    breaches, notes = [], []
    for room, tests in rooms(root):
        listing = tests / "untested.txt"
        lines = [line for line in listing.read_text().splitlines() if line and not line.startswith("#")] if listing.exists() else []
        reasons = dict(re.match(r"([^:]+\.cc): *(.*)", line + ": ").groups() for line in lines if ".cc" in line)
        for source in files_of(room, (".cc",), [""]):
            name = source.relative_to(room).as_posix()
            reason = reasons.pop(name, "").rstrip(": ")
            if any(tests.rglob(f"{source.stem}_test.cc")):
                if reason:
                    notes.append(f"{listing.relative_to(root)}: {name} has a test")
            elif not reason and name != "main.cc":
                breaches.append(f"{source.relative_to(root)}: no {tests.relative_to(root)}/{source.stem}_test.cc, "
                                f"and no reason in {listing.relative_to(root)}")
        notes += [f"{listing.relative_to(root)}: there is no {name}" for name in reasons]
    return breaches, notes


class RuleTest(unittest.TestCase):
    """The checker finds what it is there to find."""

    def tree(self, files):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        for path, text in files.items():
            file = pathlib.Path(folder.name, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return pathlib.Path(folder.name)

    def test_finds_circles(self):
        chain = {"core/a/x.h": '#include "core/a/y.h"\n', "core/a/y.cc": '#include "core/a/z.h"\n', "core/a/y.h": "", "core/a/z.h": ""}
        self.assertEqual(circle_breaches(self.tree(chain)), [])
        self.assertEqual(circle_breaches(self.tree(chain | {"core/a/z.cc": '#include "core/a/x.h"\n'})),
                         ["core/a/x core/a/y core/a/z: include each other"])

    def test_finds_what_is_too_large(self):
        self.assertEqual(len(size_breaches(self.tree({"core/a/x.cc": "\n" * 501}))), 1)
        self.assertEqual(size_breaches(self.tree({f"tests/a/{i}.cc": "\n" * 500 for i in range(25)})), [])
        self.assertEqual(len(size_breaches(self.tree({f"tests/a/{i}.cc": "" for i in range(26)}))), 1)

    def test_finds_what_has_no_test(self):
        files = {"core/a/x.cc": "", "core/a/deep/y.cc": "", "core/a/z.cc": "", "tests/a/x_test.cc": "", "tests/a/y_test.cc": ""}
        self.assertEqual(len(untested(self.tree(files))[0]), 1)
        self.assertEqual(len(untested(self.tree(files | {"tests/a/untested.txt": "z.cc:\n"}))[0]), 1)
        self.assertEqual(untested(self.tree(files | {"tests/a/untested.txt": "# why\nz.cc: data\n"})), ([], []))
        self.assertEqual(len(untested(self.tree(files | {"tests/a/untested.txt": "z.cc: data\nx.cc: data\nw.cc: data\n"}))[1]), 2)


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(RuleTest)
    if not unittest.TextTestRunner().run(suite).wasSuccessful():
        return 1
    root = pathlib.Path(sys.argv[1])
    breaches, notes = untested(root)
    breaches += circle_breaches(root) + size_breaches(root)
    print("\n".join([*breaches, *("note: " + note for note in notes)]))
    print(f"{len(breaches)} breaches")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
