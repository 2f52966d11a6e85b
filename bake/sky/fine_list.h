/* SPDX-License-Identifier: MIT */
/*
 * Lists of the parts of the sky in which lights are finer, as people and `inlay-bake sky` write
 * them. A part is four numbers:
 *
 *     azimuth height radius frequency
 *
 * azimuth and height of its middle in degrees, the azimuth from +X towards +Y, the height above the
 * horizon; the radius in degrees; the dome's frequency there. A file has one part a line and
 * remarks after #; in a text parts are separated by commas.
 */
#ifndef INLAY_BAKE_SKY_FINE_LIST_H
#define INLAY_BAKE_SKY_FINE_LIST_H

#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/optics/dome.h"

struct fine_list {
	struct dome_fine *part; /* [count] */
	int *place;		/* [count]: line of the file, or number in the text, from 1 */
	int count;
	char name[1040]; /* for messages: "FILE:" or "TEXT, part " */
};

/* Reads a file, or a text that begins with a digit or a sign. what: the key or option, for
 * messages. A path that is not absolute starts at folder ("" or NULL: the current one). -EINVAL: no
 * four numbers, or a direction that is there twice or below the horizon; errors of
 * text_file_open(). */
int fine_list_read(struct fine_list *list, const char *what, const char *text, const char *folder,
		   struct fault *fault);
void fine_list_free(struct fine_list *list); /* idempotent; zeroed is fine */

/* Creates the dome that has these parts; NULL: none. Errors of dome_create_fine(), which name the
 * part's place. */
int fine_list_dome(const struct fine_list *list, int frequency, struct dome *dome,
		   struct fault *fault);

/* Writes a part as a line of a file. */
void fine_list_write(FILE *stream, const struct dome_fine *part);

#endif
