# The settings that --set takes, SECTION.KEY, from what inlay check --sample prints. Cameras have the names
# that the samples of inlay check and of inlay devices give them.
match($0, /^\[[^]]*\]/) {
	section = substr($0, 2, RLENGTH - 2)
	gsub(/ /, ".", section)
	next
}
/^;/ { next }
match($0, /^[a-z][a-z0-9_.]* =/) {
	key = substr($0, 1, RLENGTH - 2)
	if (section !~ /^camera\./) {
		print section "." key
		next
	}
	count = split("fisheye background camera1 camera2", names, " ")
	for (i = 1; i <= count; i++)
		print "camera." names[i] "." key
}
