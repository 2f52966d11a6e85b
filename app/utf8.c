#include "app/utf8.h"

#include <stdint.h>
#include <string.h>

/* RFC 3629: what each first byte stands for, the least that its form may say, and no surrogates. */
int utf8_bytes(const char *text)
{
	static const struct {
		uint8_t mask, mark;
		uint32_t least;
	} forms[] = {
		{0x80, 0x00, 1}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}};
	const uint8_t *byte = (const uint8_t *)text;

	for (int more = 0; more < 4; more++) {
		uint32_t code = byte[0] & (uint8_t)~forms[more].mask;

		if ((byte[0] & forms[more].mask) != forms[more].mark)
			continue;
		for (int i = 1; i <= more; i++) {
			if ((byte[i] & 0xc0) != 0x80)
				return 0;
			code = code << 6 | (byte[i] & 0x3f);
		}
		if (code < forms[more].least || code > 0x10ffff ||
		    (code >= 0xd800 && code < 0xe000))
			return 0;
		return more + 1;
	}
	return 0;
}

/* C0, delete and C1 (U+0080..U+009F). */
static int is_control(const char *text)
{
	const uint8_t *byte = (const uint8_t *)text;

	return byte[0] < 0x20 || byte[0] == 0x7f || (byte[0] == 0xc2 && byte[1] < 0xa0);
}

size_t utf8_copy(char *to, size_t room, const char *from)
{
	size_t length = 0;

	if (room == 0)
		return 0;
	while (*from) {
		int bytes = utf8_bytes(from);
		const char *shown = bytes == 0 ? "?" : is_control(from) ? " " : from;
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
