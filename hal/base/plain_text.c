/* SPDX-License-Identifier: MIT */
#include "hal/base/plain_text.h"

#include <string.h>

bool text_is_utf16(const void *bytes, size_t count)
{
	const unsigned char *b = bytes;

	if (count < 2)
		return false;
	return (b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff) ||
	       (count >= 4 && !b[0] != !b[1] && !b[0] == !b[2] && !b[1] == !b[3]);
}

/* Spaces of Unicode that look like a blank, or like nothing, in UTF-8. */
static const char *const spaces[] = {
	"\u00a0", "\u1680", "\u2000", "\u2001", "\u2002", "\u2003", "\u2004",
	"\u2005", "\u2006", "\u2007", "\u2008", "\u2009", "\u200a", "\u200b",
	"\u202f", "\u205f", "\u2060", "\u3000", "\ufeff",
};

static bool has_space(const char *text, bool inner)
{
	const size_t length = strlen(text);

	for (size_t i = 0; i < sizeof(spaces) / sizeof(spaces[0]); i++) {
		const size_t bytes = strlen(spaces[i]);

		if (length >= bytes && (strncmp(text, spaces[i], bytes) == 0 ||
					strcmp(text + length - bytes, spaces[i]) == 0 ||
					(inner && strstr(text, spaces[i]))))
			return true;
	}
	return false;
}

static bool is_quoted(const char *text)
{
	static const char *const quotes[][2] = {
		{"\"", "\""},	      {"'", "'"},	    {"`", "`"},
		{"\u201c", "\u201d"}, {"\u201e", "\u201c"}, {"\u2018", "\u2019"},
		{"\u00ab", "\u00bb"},
	};
	const size_t length = strlen(text);

	for (size_t i = 0; i < sizeof(quotes) / sizeof(quotes[0]); i++) {
		const size_t first = strlen(quotes[i][0]), last = strlen(quotes[i][1]);

		if (length >= first + last && strncmp(text, quotes[i][0], first) == 0 &&
		    strcmp(text + length - last, quotes[i][1]) == 0)
			return true;
	}
	return false;
}

const char *text_oddity(const char *text, bool inner)
{
	if (has_space(text, inner))
		return "holds a no-break or other special space, expected plain blanks";
	if (is_quoted(text))
		return "stands in quotation marks, expected the same without them";
	return NULL;
}
