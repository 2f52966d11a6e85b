/* SPDX-License-Identifier: MIT */
/* Tells which bytes are UTF-8, held against an encoder for every code point. */
#include <stdbool.h>
#include <string.h>

#include "hal/base/utf8.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* Encodes a code point by the table of RFC 3629. */
static int test_utf8_encode(uint32_t code, char out[5])
{
	uint8_t *byte = (uint8_t *)out;
	int bytes = code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
	static const uint8_t mark[] = {0, 0, 0xc0, 0xe0, 0xf0};

	for (int i = bytes - 1; i > 0; i--, code >>= 6)
		byte[i] = (uint8_t)(0x80 | (code & 0x3f));
	byte[0] = (uint8_t)(mark[bytes] | code);
	byte[bytes] = 0;
	return bytes;
}

TEST("every code point")
{
	for (uint32_t code = 1; code < 0x120000; code++) {
		bool surrogate = code >= 0xd800 && code < 0xe000;
		char text[5];
		int bytes = test_utf8_encode(code, text);

		expect_equal(utf8_bytes(text), surrogate || code > 0x10ffff ? 0 : bytes, "code=%u",
			     code);
		if (bytes > 1) {
			text[bytes - 1] = '\0';
			assert_int_equal(utf8_bytes(text), 0); /* cut short */
		}
	}
	assert_int_equal(utf8_bytes(""), 0);
}

TEST("what is none")
{
	static const char *const bad[] = {
		"\x80",	    "\xbf",	    "\xc0\x80",
		"\xc1\xbf", "\xe0\x80\x80", "\xe0\x9f",
		"\xf0\x80", "\xf8\x88\x80", "\xf0\x8f\xbf\xbf",
		"\xff",	    "\xfe",	    "\xc3",
		"\xe2\x82", "\xc3(",
	};

	for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++)
		assert_int_equal(utf8_bytes(bad[i]), 0);
}

TEST("copies are clean")
{
	char to[32];

	assert_int_equal(utf8_copy(to, sizeof(to), "Müller 20 µm"), 14);
	assert_string_equal(to, "Müller 20 µm");
	utf8_copy(to, sizeof(to), "a\tb\nc\x1b[0m\x7f\xc2\x85z");
	assert_string_equal(to, "a b c [0m  z");
	utf8_copy(to, sizeof(to),
		  "ca\xff"
		  "m\xc3");
	assert_string_equal(to, "ca?m?");
	utf8_copy(to, sizeof(to), "\xc0\x80");
	assert_string_equal(to, "??");
	utf8_copy(to, sizeof(to),
		  "a\xef\xbf\xbf" /* U+FFFF, U+1FFFE, U+FDD0 */
		  "b\xf0\x9f\xbf\xbe"
		  "c\xef\xb7\x90");
	assert_string_equal(to, "a?b?c?");
}

/* Cut at any length: whole characters from the start of the text, and nothing after them. */
TEST("cut between characters")
{
	const char *text = "aä€😀bç";
	char to[32];

	for (size_t room = 0; room < 20; room++) {
		size_t length;

		memset(to, '#', sizeof(to));
		length = utf8_copy(to, room, text);
		for (size_t i = room; i < sizeof(to); i++)
			expect_equal(to[i], '#', "room=%zu, i=%zu", room, i);
		if (room == 0)
			continue;
		expect_equal(length, strlen(to), "room=%zu", room);
		expect_below(length, room, "room=%zu", room);
		expect_that(room > strlen(text) ? length == strlen(text) : room - length <= 4,
			    "room=%zu", room);
		assert_memory_equal(to, text, length);
		for (const char *at = to; *at; at += utf8_bytes(at))
			expect_above(utf8_bytes(at), 0, "room=%zu", room);
	}
}

TEST("bytes at random")
{
	struct chance chance = chance_begin("bytes_at_random");

	for (int run = 0; run < 20000; run++) {
		char from[24], to[24];
		int length = chance_int(&chance, 0, 23), room = chance_int(&chance, 1, 24);

		for (int i = 0; i < length; i++)
			from[i] = (char)chance_int(&chance, 1, 255);
		from[length] = '\0';
		length = (int)utf8_copy(to, (size_t)room, from);
		expect_equal(length, strlen(to), "run=%d", run);
		for (const char *at = to; *at; at += utf8_bytes(at)) {
			expect_above(utf8_bytes(at), 0, "run=%d", run);
			expect_that((uint8_t)*at >= 0x20 && *at != 0x7f, "run=%d", run);
		}
	}
}
