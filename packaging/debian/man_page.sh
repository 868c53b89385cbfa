#!/bin/sh
# man_page.sh COMMAND: writes the manual page of the command to stdout, from what its --help says of each verb.
set -eu
command=$1

# One help text as a section: paragraphs, then a list of options under each heading.
section() {
  printf '.SH "%s"\n' "$1"
  awk '
    function escaped(text) {
      gsub(/\\/, "\\e", text)
      gsub(/-/, "\\-", text)
      return text ~ /^[.\047]/ ? "\\&" text : text
    }
    /^Usage: / { print ".PP\n.B " escaped(substr($0, 8)); next }
    /^[^ ].*:$/ { skipped = $0 == "Subcommands:"; if (!skipped) print ".PP\n.I " escaped($0); next }
    skipped || /^ *$/ { next }
    substr($0, 1, 34) ~ /^ +$/ { print escaped(substr($0, 35)); next }
    /^  [^ ]/ {
      described = substr($0, 33, 2) == "  "
      term = described ? substr($0, 3, 30) : substr($0, 3)
      sub(/ +$/, "", term)
      print ".TP\n.B " escaped(term)
      if (described) print escaped(substr($0, 35))
      next
    }
    { print escaped($0) }
  '
}

# The verbs that a help text lists.
verbs() {
  awk '/^Subcommands:/ { listed = 1; next } listed && /^  [^ ]/ { print $1 }'
}

# walk VERB...: the section of a verb, then those of the verbs below it.
walk() {
  "$command" "$@" --help | section "motiongan${*:+ $*}"
  for verb in $("$command" "$@" --help | verbs); do walk "$@" "$verb"; done
}

printf '.TH MOTIONGAN 1 "" "%s" "User Commands"\n' "$("$command" --version)"
printf '.SH NAME\nmotiongan \\- train generative models of human motion, and generate motion\n'
walk
