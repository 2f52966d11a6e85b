# A manual page of section 1 from what facts.sh prints, on standard input.
#     awk -v name=inlay -v version=0.1.0 -v date=2026-01-31 -v about=inlay.about \
#         -f roff.awk -f command.awk
# about: its first line is what NAME says; the rest, in roff, ends the page.
function paragraph()
{
	if (pending)
		print ".PP"
	pending = 0
}
# An option's value, in capitals behind its name, is in italics.
function term(text, at)
{
	if (match(text, / [A-Z][^ ]*$/))
		return bold(substr(text, 1, RSTART - 1)) " \\fI" roff(substr(text, RSTART + 1)) "\\fR"
	return bold(text)
}
function end_usage()
{
	if (in_usage)
		print ".fi"
	in_usage = 0
}
BEGIN {
	FS = "\t"
	getline purpose < about
	printf ".\\\" Made from %s --help.\n", name
	printf ".TH %s 1 %s \"%s %s\" \"User Commands\"\n", toupper(name), date, name, version
	print ".SH NAME"
	print name " \\- " purpose
}
$1 == "command" {
	if ($2 == "") {
		print ".SH SYNOPSIS"
	} else {
		if (!commands++)
			print ".SH COMMANDS"
		print ".SS " name " " roff($2)
	}
	inside = $2
	pending = 0
	next
}
$1 == "usage" {
	if (!in_usage)
		print ".nf"
	in_usage = 1
	print roff($2)
	next
}
$1 == "break" {
	if (in_usage && inside == "") {
		end_usage()
		print ".SH DESCRIPTION"
		pending = 0
	} else {
		pending = 1
	}
	end_usage()
	next
}
$1 == "head" { paragraph(); print roff($2) ":"; next }
$1 == "item" { print ".TP"; print term($2); fill($3); pending = 1; next }
$1 == "code" { print ".nf"; print ".RS"; print roff($2); print ".RE"; print ".fi"; next }
$1 == "text" { paragraph(); fill($2); next }
END {
	end_usage()
	while ((getline line < about) > 0)
		print line
}
