# Completion for bash: commands, the methods of calibrate, the orders of send, and options, all as
# --help says; files where nothing else stands.
_wellgyro() {
  local cur=${COMP_WORDS[COMP_CWORD]} says words="" path=(wellgyro)
  if [ "$COMP_CWORD" -gt 1 ]; then path+=("${COMP_WORDS[1]}"); fi
  if [ "${COMP_WORDS[1]}" = calibrate ] && [ "$COMP_CWORD" -gt 2 ]; then path+=("${COMP_WORDS[2]}"); fi
  says=$("${path[@]}" --help 2>/dev/null)
  if [[ $cur == -* ]]; then
    words=$(grep -o -- '--[a-z][a-z0-9-]*' <<<"$says" | sort -u)
  elif [ "$COMP_CWORD" -eq "${#path[@]}" ]; then
    words=$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z0-9][a-z0-9-]*\) .*/\1/p' <<<"$says")
    if [ "${path[*]}" = "wellgyro send" ]; then
      words=$(sed -n '/^  what /,/^$/p' <<<"$says" | tr '\n,' '  ' | sed 's/.*: //')
    fi
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
}
complete -o default -o bashdefault -F _wellgyro wellgyro
