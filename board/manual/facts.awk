# The grammar of --help, for facts.sh: what it prints is described there.
function emit(kind, text, more)
{
	flush_item()
	printf "%s\t%s%s\n", kind, text, more
}
function flush_item()
{
	if (term != "")
		printf "item\t%s\t%s\n", term, meaning
	term = ""
}
function begin_item(left, right)
{
	flush_item()
	term = left
	meaning = right
}
BEGIN { printf "command\t%s\n", command }
/\t/ { gsub(/\t/, "        ") }
/^usage: / { in_usage = 1; sub(/^usage: /, ""); emit("usage", $0); next }
/^ *$/ { in_usage = 0; emit("break"); next }
in_usage { sub(/^ */, ""); emit("usage", $0); next }
/^[^ ].*:$/ { sub(/:$/, ""); emit("head", $0); next }
# An option: its letter, its name, one word in capitals that stands for its value.
match($0, /^  (-[A-Za-z](, --[a-z-]+)?|--[a-z-]+)( [A-Z][^ ]*)? +/) {
	begin_item(substr($0, 3, RLENGTH - 2), substr($0, RLENGTH + 1))
	sub(/ +$/, "", term)
	next
}
# A word, and its meaning at least two blanks further.
match($0, /^  [^ ]+( [^ ]+)*  +/) {
	begin_item(substr($0, 3, RLENGTH - 2), substr($0, RLENGTH + 1))
	sub(/ +$/, "", term)
	next
}
/^   / && term != "" { sub(/^ */, ""); meaning = meaning " " $0; next }
/^  / { sub(/^  /, ""); emit("code", $0); next }
{ emit("text", $0) }
END { flush_item() }
