/* SPDX-License-Identifier: MIT */
/* LIGHT.ini, which `inlay-calibrate light` writes key by key: a section [light]
 * (hal/colour/response.h). */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_FILE_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_FILE_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/colour/response.h"

/* Reads a file; if there is none, nothing is measured. -EINVAL and other errnos: the fault has name
 * and line. */
int light_file_read(const char *path, struct response *response, struct fault *fault);

/*
 * Writes the file with a new value for this key and its comment (lines without semicolons). Other
 * keys and their comments stay, and so do comments at the end. text is the value; NULL removes the
 * key. Returns errors of reading the old file and of writing.
 */
int light_file_set(const char *path, const char *key, const char *text, const char *comment,
		   struct fault *fault);

#endif
