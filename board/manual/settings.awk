# inlay.conf(5) from what inlay check --sample prints, on standard input.
#     awk -v version=0.1.0 -v date=2026-01-31 -v about=inlay.conf.about -f roff.awk -f settings.awk
# about: its first line is what NAME says; the rest, in roff, ends the page. What comes before
# .SH SECTIONS in it stands before the sections.
BEGIN {
	getline purpose < about
	print ".\\\" Made from inlay check --sample."
	printf ".TH INLAY.CONF 5 %s \"inlay %s\" \"File Formats\"\n", date, version
	print ".SH NAME"
	print "inlay.conf \\- " purpose
	while ((getline line < about) > 0 && line != ".SH SECTIONS")
		print line
	print ".SH SECTIONS"
}
/^; / { comment = comment (comment == "" ? "" : " ") substr($0, 3); next }
/^\[/ {
	print ".SS " roff($0)
	fill(comment)
	comment = ""
	next
}
match($0, / =/) {
	value = substr($0, RSTART + 3)
	print ".TP"
	print bold(substr($0, 1, RSTART - 1)) " = " (value == "" ? "(empty)" : roff(value))
	fill(comment)
	comment = ""
}
END {
	while ((getline line < about) > 0)
		print line
}
