/* SPDX-License-Identifier: MIT */
/* Text of mesh files: lines, words and numbers of a file in memory, which needs no 0 at its end. */
#ifndef INLAY_BAKE_MESH_FORMATS_TEXT_H
#define INLAY_BAKE_MESH_FORMATS_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct text_span {
	const char *at, *end;
};

/* The lines of a text. They end in "\n", "\r\n" or "\r". */
struct text_lines {
	struct text_span rest;
	int line;     /* number of the line that was taken last; of the first one of joined ones */
	int joined;   /* further lines that were joined to it */
	char *buffer; /* joined lines */
	size_t room;
};

/* Begins behind a byte order mark. */
void text_begin(struct text_lines *lines, const char *at, size_t bytes);

/* Takes the next line; false: there is none. */
bool text_next(struct text_lines *lines, struct text_span *line);

/* The same, where a backslash at the end of a line means that the next line continues it. The line
 * lasts until the next call. Lines too long for the memory end early. */
bool text_next_joined(struct text_lines *lines, struct text_span *line);

void text_end(struct text_lines *lines);

/* Takes the next word from a line; it is empty at the line's end. Blanks and tabs part words. */
struct text_span text_word(struct text_span *line);

/* The rest of a line without the blanks around it: a name. */
struct text_span text_name(struct text_span line);

static inline bool text_empty(struct text_span span)
{
	return span.at == span.end;
}

/* Number of characters that a message quotes. */
int text_shown(struct text_span span);

bool text_is(struct text_span word, const char *text);
bool text_begins(struct text_span line, const char *text);
bool text_is_any_case(struct text_span word, const char *text);

/* The place of a word, in any case, in a list of words with a blank between them, from 0; -1: it is
 * none of them. */
int text_place(struct text_span word, const char *list);

/* Copies a span; NULL: out of memory. */
char *text_copy(struct text_span span);

/* Reads a word that is a number, also nan and inf, which old Windows libraries write as
 * 1.#QNAN, -1.#IND00 or 1.#INF. False: it is none. */
bool text_number(struct text_span word, double *value);

/* Reads the whole number at the beginning of a word, with its sign, and moves word past it. False:
 * there is none, or it is beyond +-2^40. */
bool text_whole(struct text_span *word, int64_t *value);

#endif
