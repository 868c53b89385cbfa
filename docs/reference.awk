# What Doxygen reads in place of a file (INPUT_FILTER in docs/Doxyfile). Lines keep their numbers.
#
# Examples: the comment on the first lines describes the program, which Doxygen then shows.
# Headers: the comment on the first lines describes the file; docstrings are plain text with `code`.
# Pages: headings get the ids that GitHub gives them, after the page's name, as Doxygen has one set of ids for
# all pages; links to them follow. A link to a file that is no part of the reference becomes its text.

function page_of(path) {
  sub(/.*\//, "", path)
  sub(/\.md$/, "", path)
  return tolower(path)
}

function slug(title) {
  gsub(/\]\([^)]*\)/, "", title)
  title = tolower(title)
  gsub(/[^a-z0-9_ -]/, "", title)
  gsub(/ /, "-", title)
  return title
}

# The target of a link as Doxygen wants it; "" for a file that is no part of the reference.
function resolved(target,   page) {
  if (target ~ /^#/) return "#" page_of(FILENAME) "_" substr(target, 2)
  if (target ~ /\.md#/) {
    page = target
    sub(/#.*/, "", page)
    sub(/.*#/, "", target)
    return "#" page_of(page) "_" target
  }
  if (sub(/^(.*\/)?examples\/(.*\/)?/, "", target) || sub(/^(.*\/)?include\//, "", target)) return "@ref " target
  return target ~ /^https?:|\.(md|png|svg)$|^LICENSE$/ ? target : ""
}

# The signs that Doxygen would take for commands and tags.
function plain(text) {
  gsub(/@/, "\\@", text)
  if (header) gsub(/<[A-Za-z]/, "\\\\&", text)
  return text
}

# A piece of text that is no code.
function prose(text,   out, before, target, at) {
  out = ""
  while (match(text, /\]\([^)]*\)/)) {
    target = substr(text, RSTART + 2, RLENGTH - 3)
    before = substr(text, 1, RSTART - 1)
    text = substr(text, RSTART + RLENGTH)
    before = plain(before)
    target = resolved(target)
    if (target != "") {
      out = out before "](" target ")"
      continue
    }
    for (at = length(before); at > 0 && substr(before, at, 1) != "["; --at) continue
    out = out substr(before, 1, at - 1) substr(before, at + 1)
  }
  return out plain(text)
}

# A line of text with code spans.
function spans(text,   pieces, piece, out, i) {
  pieces = split(text, piece, "`")
  out = header ? plain(piece[1]) : prose(piece[1])
  for (i = 2; i <= pieces; ++i) out = out "`" (i % 2 == 0 ? piece[i] : header ? plain(piece[i]) : prose(piece[i]))
  return out
}

# Prints `double x = 0, y = 0;  ///< text` as two members with that text, as Doxygen would give it to one only;
# so also where the text is in the lines before, which only the first then has. Returns whether it did.
function members_of(line,   at, text, i, c, depth, count, part, type) {
  at = index(line, "///<")
  text = at ? spans(substr(line, at + 4)) : above
  if (text == "") return 0
  if (at) line = substr(line, 1, at - 1)
  sub(/; *$/, "", line)
  depth = 0
  count = 1
  split("", part)
  for (i = 1; i <= length(line); ++i) {
    c = substr(line, i, 1)
    if (c ~ /[<({[]/) ++depth
    if (c ~ /[])}>]/) --depth
    if (c == "," && depth == 0) ++count
    else part[count] = part[count] c
  }
  if (count == 1) return 0
  type = part[1]
  sub(/ *[={].*/, "", type)
  sub(/[A-Za-z_0-9]+$/, "", type)
  line = (at ? "/**" text " */" : "") part[1] ";"
  for (i = 2; i <= count; ++i) line = line " /**" text " */ " type substr(part[i], 2) ";"
  print line
  return 1
}

# The line of an example's first comment without its signs; sets `ended` behind the comment.
function told(line) {
  if (FILENAME ~ /\.py$/) {
    ended = sub(/"""$/, "", line)
    sub(/^"""/, "", line)
  } else if (FILENAME ~ /\.c$/) {
    ended = sub(/ *\*\/$/, "", line)
    sub(/^(\/\*| \*) ?/, "", line)
  } else {
    ended = !sub(/^\/\/ ?/, "", line)
    if (ended) line = ""
  }
  return plain(line)
}

FNR == 1 && FILENAME ~ /(^|\/)examples\// {
  sign = FILENAME ~ /\.py$/ ? "##" : "///"
  name = FILENAME
  sub(/.*\//, "", name)
  print sign " \\example " name
  print sign " \\details"
  example = 1
}

example {
  if (!ended) print sign " " told($0)
  next
}

FNR == 1 {
  header = FILENAME ~ /\.hpp$/
  opening = header
  fenced = titled = 0
  above = ""
}

header && /^[^\/(]*,[^\/(]*; *(\/\/\/< .*)?$/ && members_of($0) {
  above = ""
  next
}

header {
  above = /^ *\/\/\/ / && !/\\[{}]/ ? above spans(substr($0, index($0, "///") + 3)) : ""
  opening = opening && /^\/\/ /
  at = opening ? 1 : index($0, "///") + 1
  if (at > 1 || opening) {
    text = spans(substr($0, at + 2))
    if (opening && FNR == 1) {
      name = FILENAME
      sub(/^(.*\/)?include\//, "", name)
      text = " \\file " name text
    }
    $0 = substr($0, 1, at - 1) (opening ? "///" : "//") text
  }
  print
  next
}

FILENAME !~ /\.md$/ {
  print
  next
}

/^ *```/ {
  fenced = !fenced
  print
  next
}

fenced {
  print
  next
}

/^#/ {
  title = $0
  sub(/^#+ +/, "", title)
  gsub(/`/, "")
  if (titled++) $0 = $0 " {#" page_of(FILENAME) "_" slug(title) "}"
}

{ print spans($0) }
