# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# What the checks share. Arguments of each: build folder, source folder.
set -uo pipefail
build=$1
source_folder=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0

fail() { echo "failed: $*"; failures=$((failures + 1)); }
skip() { echo "skipped: $*"; exit 77; }
finish() { [[ $failures -eq 0 ]] && echo passed; exit $((failures > 0)); }

# install_tree: everything that is installed, below $scratch/root.
install_tree() {
  DESTDIR=$scratch/root cmake --install "$build" >"$scratch/install.log" 2>&1 || { cat "$scratch/install.log"; echo "failed: cmake --install"; exit 1; }
}
