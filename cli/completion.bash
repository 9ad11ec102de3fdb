# Completion of bodyopt in bash: verbs and options as its own help lists them, and files.
_bodyopt() {
  local word=${COMP_WORDS[COMP_CWORD]} verbs=() text each
  for each in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    text=$("${COMP_WORDS[0]}" "${verbs[@]}" --help 2>/dev/null) || return
    grep -q "^  $each  " <<<"$text" || break # an option, or a value
    verbs+=("$each")
  done
  text=$("${COMP_WORDS[0]}" "${verbs[@]}" --help 2>/dev/null) || return
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(grep -oP '^  (-\w,)?\K--[a-z-]+' <<<"$text")" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -W "$(grep -oP '^  \K[a-z-]+(?=  )' <<<"$text")" -- "$word")
  fi
}
# Where nothing of these fits, names of files do.
complete -o default -F _bodyopt bodyopt
