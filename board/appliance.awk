# The sample with the values of appliance.conf.
#     awk -f appliance.awk appliance.conf SAMPLE
# A value that the sample has no key for is an error.
/^\[/ { section = $0 }
FNR == NR {
	if (match($0, /^[a-z][a-z0-9_.]* = /))
		wanted[section substr($0, 1, RLENGTH - 1)] = $0
	next
}
match($0, /^[a-z][a-z0-9_.]* =/) && (section substr($0, 1, RLENGTH)) in wanted {
	where = section substr($0, 1, RLENGTH)
	print wanted[where]
	delete wanted[where]
	next
}
{ print }
END {
	for (where in wanted) {
		print "appliance: the sample has no key for " where > "/dev/stderr"
		exit 1
	}
}
