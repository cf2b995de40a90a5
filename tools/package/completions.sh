#!/bin/bash
# Writes completions for bash, zsh and fish from the help texts of the programs in BIN.
#
#   completions.sh BIN INTO
# shellcheck disable=SC2016  # what is written expands later
set -euo pipefail
export LC_ALL=C.UTF-8
bin=$1 into=$2
mkdir -p "$into"
quote="'"
mapfile -t tools < <("$bin/hapgrid" --help | sed -n 's/^  \([a-z][a-z-]*\)  *[A-Za-z].*/\1/p')

# options TOOL: a line an option: its long name, a tab, its description. feel takes those of play; the help of molecule
# needs its modules for Python.
options() {
  local tool=$1
  [[ $tool != feel ]] || tool=play
  "$bin/hapgrid" "$tool" --help 2>/dev/null | sed -nE "s/^  (-., ?)?(-. [A-Z]+, )?--([a-z-]+)[^ ]*( [^ ]+)*  +([^ ].*)$/\3\t\5/p; s/^  (-., ?)?(-. [A-Z]+, )?--([a-z-]+)[^ ]*( [^ ]+)*$/\3\t/p"
}

# cases FORMAT: a line of a shell's case for each tool that has options, with its name and those.
cases() {
  local tool names
  for tool in "${tools[@]}"; do
    names=$(options "$tool" | cut -f1 | sed 's/^/--/' | paste -sd ' ')
    # shellcheck disable=SC2059  # the format is an argument
    [[ -z $names ]] || printf "$1" "$tool" "$names"
  done
}

{
  echo '# bash completion for hapgrid'
  echo '_hapgrid() {'
  echo '  local words= word=${COMP_WORDS[COMP_CWORD]}'
  echo '  if ((COMP_CWORD == 1)); then'
  echo "    words='${tools[*]} help'"
  echo '  elif [[ $word == -* ]]; then'
  echo '    case ${COMP_WORDS[1]} in'
  cases "      %s) words='%s' ;;\n"
  echo '    esac'
  echo '  fi'
  echo '  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")'
  echo '}'
  echo 'complete -o default -F _hapgrid hapgrid'
} >"$into/hapgrid"

{
  echo '#compdef hapgrid'
  echo 'if ((CURRENT == 2)); then'
  echo "  compadd ${tools[*]} help"
  echo 'elif [[ $words[CURRENT] == -* ]]; then'
  echo '  case $words[2] in'
  cases '    %s) compadd -- %s ;;\n'
  echo '  esac'
  echo 'else'
  echo '  _files'
  echo 'fi'
} >"$into/_hapgrid"

{
  echo '# fish completion for hapgrid'
  for tool in "${tools[@]}"; do
    about=$("$bin/hapgrid" --help | sed -n "s/^  $tool  *//p" | head -n 1)
    echo "complete -c hapgrid -n __fish_use_subcommand -a $tool -d '${about//$quote/’}'"
    options "$tool" | while IFS=$'\t' read -r name what; do
      what=${what//$quote/’}
      echo "complete -c hapgrid -n '__fish_seen_subcommand_from $tool' -l $name${what:+ -d $quote$what$quote}"
    done
  done
} >"$into/hapgrid.fish"
