#!/bin/bash
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Manual pages are found by apropos, typeset without a warning, and name every command, option and setting.
. "$(dirname "$0")/lib.sh"
command -v man >/dev/null && command -v lexgrog >/dev/null || skip "needs man and lexgrog (package man-db)"
command -v groff >/dev/null || skip "needs groff"
pages=$build/docs/man

for page in "$pages"/*.gz; do
  name=$(basename "$page" .gz)
  lexgrog "$page" | grep -q "\"${name%.*} - " || fail "$name: no name and summary for apropos"
  warnings=$(MANWIDTH=80 LC_ALL=C.UTF-8 man --warnings -E UTF-8 -l "$page" 2>&1 >/dev/null)
  [[ -z $warnings ]] || fail "$name: $warnings"
  ! zgrep -q '@[A-Z]*@' "$page" || fail "$name: an unfilled place"
done

# has PAGE WORD: as it is typeset, in one line
text_of() { MANWIDTH=200 LC_ALL=C.UTF-8 man -E ascii -l "$pages/$1.gz" 2>/dev/null | sed 's/.\x08//g'; }
check_help() {
  local page=$1 text words
  shift
  text=$(text_of "$page")
  words=$("$@" --help | grep -oE '^  (-h,)?--[a-z-]+' | grep -oE -- '--[a-z-]+$')
  [[ -n $words ]] || fail "$* --help names no option"
  for word in $words; do
    [[ $word == --help || $word == --version ]] || grep -q -- "$word\b" <<<"$text" || fail "$page does not name $word of '$*'"
  done
}
check_help camlocd.8 "$CAMLOCD"
for command in $("$CAMLOC" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z-]*\) .*/\1/p'); do
  check_help camloc.1 "$CAMLOC" "$command"
done
for command in $("$CAMLOC_MAP" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z-]*\) .*/\1/p'); do
  check_help camloc-map.1 "$CAMLOC_MAP" "$command"
done
text=$(text_of camlocd.toml.5)
for key in $("$CAMLOCD" --config /dev/null --print-config | sed -n 's/^\([a-z_]*\) = .*/\1/p'); do
  grep -q "^ *$key = " <<<"$text" || fail "camlocd.toml.5 does not name $key"
done
finish
