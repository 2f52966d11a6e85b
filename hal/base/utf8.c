/* SPDX-License-Identifier: MIT */
#include "hal/base/utf8.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Decodes a character by RFC 3629: forms lists the mask and mark of each first byte, and the least
 * code of that length; surrogates are refused. Returns the number of bytes, 0: not UTF-8. */
static int decode_character(const char *text, uint32_t *code)
{
	static const struct {
		uint8_t mask, mark;
		uint32_t least;
	} forms[] = {
		{0x80, 0x00, 1}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}};
	const uint8_t *byte = (const uint8_t *)text;

	for (int more = 0; more < 4; more++) {
		uint32_t c = byte[0] & (uint8_t)~forms[more].mask;

		if ((byte[0] & forms[more].mask) != forms[more].mark)
			continue;
		for (int i = 1; i <= more; i++) {
			if ((byte[i] & 0xc0) != 0x80)
				return 0;
			c = c << 6 | (byte[i] & 0x3f);
		}
		*code = c;
		return c < forms[more].least || c > 0x10ffff || (c >= 0xd800 && c < 0xe000)
			       ? 0
			       : more + 1;
	}
	return 0;
}

int utf8_bytes(const char *text)
{
	uint32_t code;

	return decode_character(text, &code);
}

/* C0, delete and C1 of ISO 6429. */
static bool is_control(uint32_t code)
{
	return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

/* The noncharacters of Unicode, which cairo refuses. */
static bool is_no_character(uint32_t code)
{
	return (code & 0xfffe) == 0xfffe || (code >= 0xfdd0 && code <= 0xfdef);
}

size_t utf8_copy(char *to, size_t room, const char *from)
{
	size_t length = 0;

	if (room == 0)
		return 0;
	while (*from) {
		uint32_t code;
		int bytes = decode_character(from, &code);
		const char *shown = bytes == 0 || is_no_character(code) ? "?"
				    : is_control(code)			? " "
									: from;
		size_t size = shown == from ? (size_t)bytes : 1;

		if (length + size >= room)
			break;
		memcpy(to + length, shown, size);
		length += size;
		from += bytes ? bytes : 1;
	}
	to[length] = '\0';
	return length;
}

void utf8_write_json(FILE *stream, const char *text)
{
	fputc('"', stream);
	while (*text) {
		const int bytes = utf8_bytes(text);

		if (bytes == 0)
			fputs("\\ufffd", stream);
		else if (*text == '"' || *text == '\\')
			fprintf(stream, "\\%c", *text);
		else if (*text > 0 && *text < 0x20)
			fprintf(stream, "\\u%04x", (unsigned)*text);
		else
			fwrite(text, 1, (size_t)bytes, stream);
		text += bytes ? bytes : 1;
	}
	fputc('"', stream);
}
