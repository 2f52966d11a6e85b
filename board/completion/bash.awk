# A bash completion from the rows of options.awk, on standard input.
#     awk -v name=inlay -v keys="basis.file basis.pose ..." -f bash.awk
# Where nothing of it fits, bash completes file names.
function quoted(text) { return "'" text "'" }
BEGIN { FS = "\t" }
{
	if (!($1 in words) && $1 != "")
		order[++commands] = $1
	words[$1] = words[$1] (words[$1] == "" ? "" : " ") $2
	if ($3 == "SECTION.KEY=VALUE")
		settings = settings (settings == "" ? "" : " | ") quoted($1 " " $2)
	else if ($3 != "")
		valued = valued (valued == "" ? "" : " | ") quoted($1 " " $2)
}
END {
	entry = "_" name
	gsub(/-/, "_", entry)
	print "# Made from " name " --help."
	print entry "()\n{"
	print "\tlocal word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} words="
	print "\tCOMPREPLY=()"
	print "\tif [ \"$COMP_CWORD\" -eq 1 ]; then"
	print "\t\tcommand="
	print "\tfi"
	print "\tcase \"$command ${COMP_WORDS[COMP_CWORD - 1]}\" in"
	if (settings != "") {
		print "\t" settings ")"
		print "\t\tmapfile -t COMPREPLY < <(compgen -W " quoted(keys) " -S = -- \"$word\")"
		print "\t\tcompopt -o nospace"
		print "\t\treturn"
		print "\t\t;;"
	}
	print "\t" valued ") return ;;"
	print "\tesac"
	print "\tcase \"$command\" in"
	print "\t'') words=" quoted(words[""]) " ;;"
	for (i = 1; i <= commands; i++)
		print "\t" order[i] ") words=" quoted(words[order[i]]) " ;;"
	print "\tesac"
	print "\tmapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")"
	print "}"
	print "complete -o default -F " entry " " name
}
