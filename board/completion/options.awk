# What the completions of both shells are made from: facts.sh's lines, one row a word.
#     COMMAND <tab> WORD <tab> ARGUMENT <tab> MEANING
# COMMAND is empty for the program's own words; an option with a letter makes two rows.
function row(word, argument, meaning) { print command, word, argument, meaning }
BEGIN {
	FS = OFS = "\t"
	row("--help", "", "what there is")
	row("--version", "", "the version")
}
$1 == "command" {
	command = $2
	if (command != "")
		row("--help", "", "the options")
	next
}
$1 != "item" || $2 == "--help" { next }
$2 ~ /^-/ {
	argument = ""
	if (match($2, / [A-Z][^ ]*$/)) {
		argument = substr($2, RSTART + 1)
		$2 = substr($2, 1, RSTART - 1)
	}
	count = split($2, words, ", ")
	for (i = 1; i <= count; i++)
		row(words[i], argument, $3)
	next
}
$2 ~ /^[a-z][a-z-]*( ([A-Z][^ ]*|\[[^ ]*\]))?$/ {
	# A file is for the shell to complete.
	argument = $2 ~ / FILE/ ? "FILE" : ""
	sub(/ .*/, "", $2)
	row($2, argument, $3)
}
