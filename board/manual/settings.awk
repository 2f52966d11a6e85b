# A manual page of section 5 from a file that holds every key, on standard input: what inlay check
# --sample or inlay-bake render --print-scene prints.
#     awk -v title=inlay.conf -v names="inlay.conf, kiosk.conf" -v from="inlay check --sample" \
#         -v version=0.1.0 -v date=2026-01-31 -v about=inlay.conf.about -f roff.awk -f settings.awk
# names: what NAME lists; left out: title. about: its first line is what NAME says of them; what
# comes before .SH SECTIONS in it stands before the sections, the rest ends the page.
function item(key, value)
{
	print ".TP"
	print bold(key) value
	fill(comment)
	comment = ""
}
BEGIN {
	getline purpose < about
	printf ".\\\" Made from %s.\n", from
	printf ".TH %s 5 %s \"inlay %s\" \"File Formats\"\n", toupper(title), date, version
	print ".SH NAME"
	print (names == "" ? title : names) " \\- " purpose
	while ((getline line < about) > 0 && line != ".SH SECTIONS")
		print line
	print ".SH SECTIONS"
}
# A key without a default stands behind a semicolon.
/^; [a-z0-9_]+ =$/ && sub(/ must be given:$/, "", comment) {
	item(substr($0, 3, length($0) - 4), " (must be given)")
	next
}
# A section that has no instance by default stands behind a semicolon, too.
/^; \[/ { sub(/^; /, "") }
/^; / { comment = comment (comment == "" ? "" : " ") substr($0, 3); next }
/^\[/ {
	print ".SS " roff($0)
	fill(comment)
	comment = ""
	next
}
match($0, / =/) {
	value = substr($0, RSTART + 3)
	item(substr($0, 1, RSTART - 1), " = " (value == "" ? "(empty)" : roff(value)))
}
END {
	while ((getline line < about) > 0)
		print line
}
