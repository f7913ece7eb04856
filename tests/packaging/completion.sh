#!/bin/bash
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Completion in bash offers every command and option that --help lists, the frame sources, settings, and files of the right kind.
. "$(dirname "$0")/lib.sh"
for program in camlocd camloc camloc-map camloc-camera camloc-bench camloc-sim camloc-train; do
  # shellcheck disable=SC1090
  . "$build/docs/completion/$program" || fail "$program: not valid"
done

# complete_line LINE: what is offered at its end, one line
complete_line() {
  COMP_LINE=$1 COMP_POINT=${#1} COMPREPLY=()
  local program=${1%% *}
  "_${program//-/_}"
  echo "${COMPREPLY[*]}"
}
# offers LINE WORD...: all of these, perhaps others
offers() {
  local line=$1 offered word
  offered=" $(complete_line "$line") "
  shift
  for word in "$@"; do [[ $offered == *" $word "* ]] || fail "'$line' does not offer $word but$offered"; done
}
# is_exactly LINE WORDS
is_exactly() { [[ $(complete_line "$1") == "$2" ]] || fail "'$1' offers '$(complete_line "$1")', not '$2'"; }

# Every command and option, by the programs' own lists.
check_options() {
  local line=$1 names
  shift
  mapfile -t names < <("$@" --help | grep -oE '^  (-h,)?--[a-z-]+' | grep -oE -- '--[a-z-]+$')
  offers "$line --" "${names[@]}"
}
check_options camlocd "$CAMLOCD"
commands_of() { "$@" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z-]*\) .*/\1/p'; }
num_commands=0
for command in $(commands_of "$CAMLOC"); do
  offers "camloc " "$command"
  check_options "camloc $command" "$CAMLOC" "$command"
  for below in $(commands_of "$CAMLOC" "$command"); do
    offers "camloc $command " "$below"
    check_options "camloc $command $below" "$CAMLOC" "$command" "$below"
  done
  num_commands=$((num_commands + 1))
done
[[ $num_commands -ge 7 ]] || fail "only $num_commands commands in 'camloc --help'"
for command in $(commands_of "$CAMLOC_MAP"); do
  offers "camloc-map " "$command"
  offers "camloc map " "$command"
  check_options "camloc map $command" "$CAMLOC_MAP" "$command"
done
offers "camloc " bench sim

# Values. The list of schemes is the daemon's own.
schemes=$("$CAMLOCD" --config /dev/null --set source.url=nothing://x --check-config 2>&1 | sed -n 's/.*it knows //p' | tr -d ',:/')
[[ -n $schemes ]] || fail "camlocd does not say which frame sources it knows"
for scheme in $schemes; do offers "camloc localize --sequence ${scheme:0:2}" "$scheme://"; done
is_exactly "camlocd --set source.url=rep" "replay://"
is_exactly "camlocd --set map.p" "map.path="
is_exactly "camloc localize --mode " "track single"
is_exactly "camloc localize --mode=si" "single"
is_exactly "camloc monitor --count " ""
is_exactly "camloc ctl --socket /run/x.sock rel" "reload"

cd "$scratch" || exit 1
mkdir folder && touch a.cmap a.toml a.yaml a.txt "with blank.cmap"
is_exactly "camloc map info a" "a.cmap"
[[ $(complete_line "camloc map info ") == *"with blank.cmap"* ]] || fail "a map with a blank in its name is not offered"
[[ $(complete_line "camloc localize --camera a" | tr ' ' '\n' | sort | paste -sd' ') == "a.toml a.yaml" ]] || fail "--camera offers other files"
is_exactly "camlocd --config a" "a.toml"
is_exactly "camlocd --set map.path=a" "a.cmap"
is_exactly "camloc map export a.cmap --colmap f" "folder"
finish
