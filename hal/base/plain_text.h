/* SPDX-License-Identifier: MIT */
/* What editors and web pages put into text files, and people do not see. */
#ifndef INLAY_HAL_BASE_PLAIN_TEXT_H
#define INLAY_HAL_BASE_PLAIN_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Whether bytes are the beginning of UTF-16 text: a byte order mark, or a zero in each pair. */
bool text_is_utf16(const void *bytes, size_t count);

/* What in a word or a value is not plain text: a space that is not the common one, quotation marks
 * around it. It follows a name, as in "holds a no-break space, expected plain blanks"; NULL:
 * nothing. inner: spaces in the middle count, too, as in a word; else only those at its ends, as in
 * a name. */
const char *text_oddity(const char *text, bool inner);

#endif
