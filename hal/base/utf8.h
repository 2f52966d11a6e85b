/* SPDX-License-Identifier: MIT */
/* Makes text from devices and files safe to show: valid UTF-8, cut between characters. */
#ifndef INLAY_HAL_BASE_UTF8_H
#define INLAY_HAL_BASE_UTF8_H

#include <stddef.h>
#include <stdio.h>

/* Number of bytes of the character at text: 1..4; 0 at the end, or where it is not UTF-8. */
int utf8_bytes(const char *text);

/* Copies as many whole characters as fit into room bytes, terminator included; room 0: writes
 * nothing. Bytes that are not UTF-8 and noncharacters become '?', control characters a blank.
 * Returns the number of bytes written before the terminator. */
size_t utf8_copy(char *to, size_t room, const char *from);

/* Writes text between quotation marks as JSON wants it (RFC 8259). Bytes that are not UTF-8 become
 * U+FFFD. */
void utf8_write_json(FILE *stream, const char *text);

#endif
