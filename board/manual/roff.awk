# Text as roff, for the other files of this folder: nothing in it is taken for a request.
function roff(text)
{
	gsub(/\\/, "\\e", text)
	gsub(/-/, "\\-", text)
	gsub(/'/, "\\(aq", text)
	gsub(/`/, "\\(ga", text)
	gsub(/~/, "\\(ti", text)
	gsub(/\^/, "\\(ha", text)
	sub(/^\./, "\\\\\\&.", text)
	return text
}
# In lines of less than 80 bytes.
function fill(text, words, count, i, line)
{
	count = split(text, words, " ")
	for (i = 1; i <= count; i++) {
		if (line != "" && length(line) + length(roff(words[i])) > 78) {
			print line
			line = ""
		}
		line = line (line == "" ? "" : " ") roff(words[i])
	}
	if (line != "")
		print line
}
function bold(text) { return "\\fB" roff(text) "\\fR" }
