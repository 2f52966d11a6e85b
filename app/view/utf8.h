/* SPDX-License-Identifier: MIT */
/* Text from devices and files made safe to show: valid UTF-8, cut between characters. */
#ifndef INLAY_APP_VIEW_UTF8_H
#define INLAY_APP_VIEW_UTF8_H

#include <stddef.h>

/* Bytes of the character that text begins with: 1..4; 0 at the end, or where it is not UTF-8. */
int utf8_bytes(const char *text);

/* Copies as many whole characters as there is room for, and ends them with a zero byte (room 0:
 * nothing is written). What is not UTF-8, or no character, becomes '?', what controls a terminal a
 * blank. Returns the
 * length of what was written. */
size_t utf8_copy(char *to, size_t room, const char *from);

#endif
