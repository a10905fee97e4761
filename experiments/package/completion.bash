# SPDX-License-Identifier: BSD-3-Clause
# Completes commands and options of montecarta in bash, based on its help.
_montecarta() {
  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} words
  if [ "$COMP_CWORD" -eq 1 ]; then
    words=$(montecarta help 2>/dev/null | sed -n 's/^  \([a-z]*\)  .*/\1/p')
  elif [[ $word == -* ]]; then
    words=$(montecarta "$command" --help 2>/dev/null | grep -o -- '--[a-z][a-z-]*')
  elif [ "$command" = run ] || [ "$command" = check ]; then
    words=$(montecarta list studies 2>/dev/null | sed -n 's/^\([a-z0-9_]\+\)  .*/\1/p')
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word"; compgen -f -- "$word")
}
complete -o filenames -F _montecarta montecarta
