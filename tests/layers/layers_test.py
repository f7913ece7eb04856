#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""The layer rule, checked on the #include lines of every file.

    tests -> everything    daemon -> drivers, core, lcmtypes
    tools: common <- jobs, mapping/* <- programs; all -> drivers, core; camloc -> lcmtypes
    drivers -> core/base, core/geometry    core: base <- geometry <- features <- map <- localize, slam

core/ has no thread, socket, file watcher, clock read or print. OpenCV is for what has a package of its own: camloc-camera,
camloc-bench and the plug-in that runs networks. Usage: layers_test.py ROOT
"""
import pathlib
import re
import sys
import tempfile
import unittest

CORE = ["core/base", "core/geometry", "core/io", "core/features", "core/registration", "core/map", "core/mapmaking", "core/localize"]
LCM_TYPES = ["camloc", "bot_core"]
# What a folder may include besides itself. Of several that match a file, the longest rules.
ALLOWED = {folder: CORE[:i] for i, folder in enumerate(CORE)}
ALLOWED["core/features"] = ["core/base", "core/geometry"]
ALLOWED["core/localize"] = CORE[:6]
ALLOWED["core/registration"] = ["core/base", "core/geometry", "core/features"]
ALLOWED["core/coarse"] = CORE[:3]
ALLOWED["core/optimize"] = ["core/base", "core/geometry"]
ALLOWED["core/dense"] = ["core/base", "core/geometry", "core/features", "core/registration"]
ALLOWED["core/slam"] = [*CORE[:7], "core/optimize", "core/dense"]
ALLOWED["core/merge"] = [*ALLOWED["core/slam"], "core/slam"]
ALLOWED["plugins/opencv_dnn"] = ["core/coarse"]
ALLOWED["drivers"] = ["core/base", "core/geometry", "core/io"]
ALLOWED["daemon"] = ["drivers", *CORE, "core/coarse", *LCM_TYPES]
# Tools: what they share, libraries of one job each, those of map making in the order in which they build on each other, and
# programs, which include libraries and not each other.
SHARED = ["drivers", *CORE, "core/coarse", "core/optimize", "core/dense", "core/slam", "core/merge", "tools/common"]
MAPPING = [f"tools/mapping/{room}" for room in ("site", "picture", "colmap", "build", "eval")]
JOBS = [f"tools/{job}" for job in ("evaluation", "recording", "doctor", "monitor")]
ALLOWED["tools/mapping/cloud"] = CORE[:3]
ALLOWED |= {folder: SHARED for folder in ("tools/common", *JOBS[:3], "tools/camloc-camera", "tools/camloc-sim")}
ALLOWED |= {room: [*SHARED, *MAPPING[:i]] for i, room in enumerate(MAPPING)}
ALLOWED["tools/mapping/eval"].append("tools/mapping/cloud")
ALLOWED["tools/monitor"] = [*SHARED, *LCM_TYPES]
ALLOWED["tools/camloc"] = [*SHARED, *JOBS, *LCM_TYPES]
ALLOWED["tools/camloc-map"] = [*SHARED, "tools/mapping"]
ALLOWED["tools/camloc-bench"] = [*SHARED, "tools/evaluation", "tools/mapping"]
ALLOWED["tools/training"] = [*SHARED, "tools/evaluation", "tools/mapping"]
ALLOWED["tools/camloc-train"] = [*SHARED, "tools/training"]

CORE_FORBIDDEN_HEADERS = re.compile(
    r"^<(thread|future|mutex|shared_mutex|condition_variable|semaphore|latch|barrier|stop_token|pthread\.h|iostream|ostream|"
    r"print|syslog\.h|sys/socket\.h|sys/un\.h|netinet/.*|arpa/.*|netdb\.h|poll\.h|sys/epoll\.h|sys/inotify\.h|sys/time\.h|"
    r"time\.h|ctime|lcm/.*|systemd/.*)>$")
PRINT_CALLS = re.compile(
    r"\b(std::)?(printf|fprintf|vprintf|vfprintf|puts|fputs|putchar|perror|syslog)\s*\(|std::(cout|cerr|clog)\b")
CLOCK_CALLS = re.compile(
    r"(steady|system|high_resolution)_clock::now|\b(clock_gettime|gettimeofday|clock)\s*\(|\btime\s*\((nullptr|NULL|0)\)")
# The library of map making tells an observer (core/base/work_observer.h) what the programs print, and asks it whether to stop.
MAPPING_FORBIDDEN_HEADERS = re.compile(
    r'^("tools/common/(command_line|terminal_observer)\.h"|<(iostream|csignal|CLI/.*)>)$')
OPENCV_PROGRAMS = ("tools/camloc-camera/", "tools/camloc-bench/", "plugins/opencv_dnn/")
INCLUDE = re.compile(r'^\s*#\s*include\s*(<[^>]+>|"[^"]+")')


def layer_of(path):
    """The longest folder with a rule that holds `path`, or None."""
    folders = [folder for folder in ALLOWED if path.startswith(folder + "/")]
    return max(folders, key=len) if folders else None


def include_error(path, layer, target):
    """Why the file `path` of `layer` may not include `target` (with its brackets or quotes), or None."""
    name = target[1:-1]
    if layer.startswith("core/") and CORE_FORBIDDEN_HEADERS.match(target):
        return "core has no thread, socket, watcher, clock or print"
    if layer.startswith("tools/mapping/") and MAPPING_FORBIDDEN_HEADERS.match(target):
        return "the library of map making neither prints nor reads signals: it has an observer"
    if target.startswith("<opencv2/") and not path.startswith(OPENCV_PROGRAMS):
        return "OpenCV brings Mesa, LLVM and X11"
    if target.startswith('"') and "/" not in name:
        return "write the path from the top of the tree"
    is_ours = name.split("/")[0] in ("core", "plugins", "drivers", "daemon", "tools", "tests", *LCM_TYPES)
    if not is_ours or any(name.startswith(folder + "/") for folder in [layer, *ALLOWED[layer]]):
        return None
    return f"{layer} may include only itself{''.join(', ' + folder for folder in ALLOWED[layer])}"


def violations(root):
    """Lines "file:line: what: why" for every breach in the tree, and the number of files read."""
    found, num_files = [], 0
    for top in ("core", "plugins", "drivers", "daemon", "tools"):
        for file in sorted((root / top).rglob("*")):
            path = file.relative_to(root).as_posix()
            if file.suffix not in (".h", ".cc", ".hpp", ".cpp", ".c"):
                continue
            num_files += 1
            layer = layer_of(path)
            if layer is None:
                found.append(f"{path}:1: belongs to no layer")
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                include = INCLUDE.match(line)
                error = include_error(path, layer, include.group(1)) if include else None
                if error:
                    found.append(f"{path}:{number}: {include.group(1)}: {error}")
                code = line.split("//")[0]
                call = PRINT_CALLS.search(code) if path.startswith(("core/", "tools/mapping/")) else None
                call = call or (CLOCK_CALLS.search(code) if path.startswith("core/") else None)
                if call:
                    found.append(f"{path}:{number}: {call.group(0).strip()}: this layer does not print, and core reads no clock")
    return found, num_files


class RuleTest(unittest.TestCase):
    """The checker finds what it is there to find."""

    def check(self, path, line):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, path)
            file.parent.mkdir(parents=True)
            file.write_text(line + "\n")
            return violations(pathlib.Path(folder))[0]

    def test_finds_breaches(self):
        for path, line in [("core/base/a.h", '#include "core/geometry/rigid3.h"'), ("core/features/a.cc", '#include "core/map/map_view.h"'),
                           ("core/map/a.cc", '#include "drivers/replay_source.h"'), ("drivers/a.cc", '#include "core/map/map_view.h"'),
                           ("drivers/a.cc", '#include "camloc/pose_t.hpp"'), ("daemon/a.cc", '#include "tools/camloc/commands.h"'),
                           ("tools/camloc/a.cc", '  #  include "daemon/config.h"'), ("core/base/a.cc", "#include <thread>"),
                           ("core/map/a.cc", "#include <iostream>"), ("core/map/a.cc", 'std::fprintf(stderr, "x");'),
                           ("core/localize/a.cc", "auto t = std::chrono::steady_clock::now();"), ("daemon/a.cc", "#include <opencv2/highgui.hpp>"),
                           ("tools/camloc/a.cc", "#include <opencv2/core.hpp>"), ("core/map/a.cc", '#include "map_view.h"'), ("core/a.cc", ""),
                           ("tools/camloc-map/a.cc", '#include "tools/camloc/commands.h"'), ("tools/mapping/a.cc", ""),
                           ("tools/mapping/site/a.cc", '#include "tools/mapping/build/map_pipeline.h"'),
                           ("tools/mapping/cloud/a.cc", '#include "tools/common/text_format.h"'),
                           ("tools/mapping/build/a.cc", '#include "tools/camloc-map/commands.h"'),
                           ("tools/mapping/build/a.cc", '#include "tools/common/terminal_observer.h"'),
                           ("tools/mapping/eval/a.cc", 'std::printf("x");'), ("tools/doctor/a.cc", '#include "camloc/pose_t.hpp"'),
                           ("plugins/opencv_dnn/a.cc", '#include "core/map/map_view.h"'),
                           ("core/coarse/a.cc", "#include <opencv2/dnn.hpp>"), ("core/coarse/a.cc", '#include "core/map/map_view.h"'),
                           ("tools/recording/a.cc", '#include "tools/evaluation/perturbation.h"')]:
            self.assertEqual(len(self.check(path, line)), 1, (path, line))

    def test_allows_what_is_allowed(self):
        for path, line in [("core/localize/a.cc", '#include "core/map/map_view.h"'), ("drivers/a.cc", '#include "core/geometry/camera.h"'),
                           ("daemon/a.cc", '#include "camloc/pose_t.hpp"'), ("tools/camloc-map/a.cc", '#include "tools/mapping/build/map_pipeline.h"'),
                           ("tools/mapping/eval/a.cc", '#include "tools/mapping/cloud/point_cloud.h"'),
                           ("tools/camloc-bench/a.cc", '#include "tools/evaluation/sequence_run.h"'),
                           ("plugins/opencv_dnn/a.cc", "#include <opencv2/dnn.hpp>"),
                           ("tools/camloc-bench/a.cc", "#include <opencv2/core.hpp>"), ("core/map/a.cc", "// printf() is not used here"),
                           ("core/base/a.h", "#include <vector>"), ("core/map/a.cc", "std::snprintf(text, 3, format);")]:
            self.assertEqual(self.check(path, line), [], (path, line))


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(RuleTest)
    if not unittest.TextTestRunner().run(suite).wasSuccessful():
        return 1
    found, num_files = violations(pathlib.Path(sys.argv[1]))
    print("\n".join(found))
    print(f"{num_files} files, {len(found)} breaches of the layer rule")
    return 1 if found or num_files == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
