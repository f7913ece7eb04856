#!/bin/bash
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Every C++ file is as clang-format of Debian 12 writes it. Usage: format.sh ROOT; exit code 77 where that cannot be told.
cd "$1" || exit 1
command -v clang-format >/dev/null || { echo "skipped: needs clang-format; tools/install-deps --tests installs it"; exit 77; }
[[ $(clang-format --version) == *"version 14."* ]] || { echo "skipped: versions of clang-format disagree, and this one is not 14"; exit 77; }
files=$(git ls-files '*.cc' '*.h' 2>/dev/null) && [[ -n $files ]] || { echo "skipped: not a checkout of git"; exit 77; }
xargs -d '\n' -n 50 -P 2 clang-format --dry-run -Werror <<<"$files" || { echo "clang-format -i makes the files above right"; exit 1; }
