# The settings that --set takes, SECTION.KEY, from what inlay check --sample prints.
match($0, /^\[[^]]*\]/) {
	section = substr($0, 2, RLENGTH - 2)
	gsub(/ /, ".", section)
	next
}
/^;/ { next }
match($0, /^[a-z][a-z0-9_.]* =/) { print section "." substr($0, 1, RLENGTH - 2) }
