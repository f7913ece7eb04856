# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# bash completion for @PROGRAM@. Written from the program's --help; see docs/completion.py.

# "COMMAND options", "COMMAND commands", "COMMAND positional" and "COMMAND --option": words, or the kind of a value.
declare -gA @FUNCTION@_table=(
@TABLE@
)

# Puts into COMPREPLY what of the words $2 begins with $1. bash has cut the word at ':' and '=': what it has already is left out.
@FUNCTION@_reply() {
  local word kept=${1%"${1##*[=:]}"}
  while IFS= read -r word; do COMPREPLY+=("${word#"$kept"}"); done < <(compgen -W "$2" -- "$1")
  # More is to be typed after these.
  [[ ${COMPREPLY[0]-} != *[=/] ]] || compopt -o nospace 2>/dev/null
}

# Files whose name matches the pattern $2, and folders. After "key=" bash completes the file name alone.
@FUNCTION@_files() {
  local file start=$1
  start=${start#"${start%"${start##*=}"}"}
  compopt -o filenames 2>/dev/null
  while IFS= read -r file; do
    if [[ -d $file || $file == $2 ]]; then COMPREPLY+=("$file"); fi
  done < <(compgen -f -- "$start")
}

# Completes the value $2 of kind $1.
@FUNCTION@_value() {
  case $1 in
    none) ;;
    =*) @FUNCTION@_reply "$2" "${1#=}" ;;
    folder) @FUNCTION@_files "$2" / ;;
    map) @FUNCTION@_files "$2" '*.cmap' ;;
    toml) @FUNCTION@_files "$2" '*.toml' ;;
    camera) @FUNCTION@_files "$2" '*.@(toml|yaml|yml)' ;;
    source)
      @FUNCTION@_reply "$2" '@SCHEMES@'
      [[ $2 == *:* ]] || @FUNCTION@_files "$2" /
      ;;
    setting)
      case $2 in
        source.url=*) @FUNCTION@_reply "$2" "$(printf 'source.url=%s ' @SCHEMES@)" ;;
        map.path=*) @FUNCTION@_files "$2" '*.cmap' ;;
        source.camera=*) @FUNCTION@_value camera "$2" ;;
        *=*) ;;
        *) @FUNCTION@_reply "$2" "$(printf '%s= ' @SETTINGS@)" ;;
      esac
      ;;
    *) @FUNCTION@_files "$2" '*' ;;
  esac
}

@FUNCTION@() {
  # The line is read anew, cut at blanks only: '=' and ':' are part of settings and URLs.
  local line=${COMP_LINE:0:COMP_POINT} command=@PROGRAM@ kind='' word words current
  current=${line##*[[:space:]]}
  read -ra words <<<"${line%"$current"}"
  COMPREPLY=()
  for word in "${words[@]:1}"; do
    if [[ -n $kind ]]; then
      kind=''  # that was the option's value
    elif [[ $word == -* ]]; then
      kind=${@FUNCTION@_table[$command $word]-}
    elif [[ " ${@FUNCTION@_table[$command commands]-} " == *" $word "* ]]; then
      command+=" $word"
    fi
  done
  if [[ -n $kind ]]; then
    @FUNCTION@_value "$kind" "$current"
  elif [[ $current == --*=* ]]; then
    kind=${@FUNCTION@_table[$command ${current%%=*}]-}
    [[ -z $kind ]] || @FUNCTION@_value "$kind" "${current#*=}"
  elif [[ $current == -* ]]; then
    @FUNCTION@_reply "$current" "${@FUNCTION@_table[$command options]-}"
  else
    @FUNCTION@_reply "$current" "${@FUNCTION@_table[$command commands]-}"
    kind=${@FUNCTION@_table[$command positional]-}
    [[ -z $kind ]] || @FUNCTION@_value "$kind" "$current"
  fi
}

complete -F @FUNCTION@ @PROGRAM@
