/* SPDX-License-Identifier: MIT */
/* The file that `inlay-calibrate light` writes: a section [light] (hal/colour/response.h), key by key. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_FILE_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_FILE_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/colour/response.h"

/* What a file says; nothing measured where there is no such file. -EINVAL and other errnos: with
 * its name and line. */
int light_file_read(const char *path, struct response *response, struct fault *fault);

/*
 * Writes the file with this key's line in place of the one it had, and what was said about it:
 * comment, lines without their semicolons. Other keys and their comments stay, and comments at the
 * end. text is the value; NULL: the key goes. Errors of reading what is there and of writing.
 */
int light_file_set(const char *path, const char *key, const char *text, const char *comment,
		   struct fault *fault);

#endif
