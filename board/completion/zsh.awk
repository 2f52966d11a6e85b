# A zsh completion from the rows of options.awk, on standard input.
#     awk -v name=inlay -v keys="basis.file basis.pose ..." -f zsh.awk
function escaped(text)
{
	gsub(/'/, "'\"'\"'", text)
	gsub(/\\|\[|\]|:/, "\\\\&", text)
	return text
}
function option(word, argument, meaning, text)
{
	text = (meaning ~ /given again/ ? "*" : "") word "[" escaped(meaning) "]"
	if (argument == "SECTION.KEY=VALUE")
		text = text ":" escaped(argument) ":(" keys ")"
	else if (argument != "")
		text = text ":" escaped(argument) ":_default"
	return "'" text "'"
}
BEGIN { FS = "\t"; gsub(/ /, "= ", keys); keys = keys "=" }
$1 == "" && $2 ~ /^-/ { own = own " \\\n\t\t" option($2, $3, $4); next }
$1 == "" { commands = commands "\n\t\t\t'" $2 ":" escaped($4) "'"; next }
{
	if (!($1 in options))
		order[++count] = $1
	if ($2 ~ /^-/)
		options[$1] = options[$1] " \\\n\t\t\t\t" option($2, $3, $4)
	else
		bare[$1] = bare[$1] " " $2
}
END {
	print "#compdef " name
	print "# Made from " name " --help."
	print "local context state state_descr line"
	print "typeset -A opt_args"
	print "local -a commands"
	print "_arguments -C" own " \\\n\t\t'1:command:->command' '*::argument:->argument'"
	print "case $state in"
	print "command)"
	print "\tcommands=(" commands ")"
	print "\t_describe command commands"
	print "\t;;"
	print "argument)"
	print "\tcase $words[1] in"
	for (i = 1; i <= count; i++) {
		first = bare[order[i]] == "" ? "" : "'1: :(" substr(bare[order[i]], 2) ")' "
		print "\t" order[i] ")"
		print "\t\t_arguments" options[order[i]] " \\\n\t\t\t\t" first "'*: :_files'"
		print "\t\t;;"
	}
	print "\tesac"
	print "\t;;"
	print "esac"
}
