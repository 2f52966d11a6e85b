/* SPDX-License-Identifier: MIT */
/*
 * Reader of the part of YAML in which OpenCV, ROS and Kalibr write lenses: keys in the first
 * column, or below the name of one of several cameras; matrices as blocks of rows, cols and data,
 * or as lists. Each may also stand in braces on one line or several, as JSON does. Unknown keys are
 * ignored; known ones must be complete.
 */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/convert/convert_words.h"
#include "hal/base/text_file.h"

struct yaml_reader {
	struct text_file file;
	struct lens_words *words;
	bool held;  /* next_line() returns the current line again */
	bool begun; /* there was a key: the next document is another message */
	bool ended; /* there was such a document */
	/* why there is no next line, other than the end of the file; the fault says it */
	int err;
	int block;		  /* enum yaml_block */
	char top[WORDS_NAME_MAX]; /* the key in the first column that holds the block */
	int depth;		  /* open braces */
};

enum yaml_block { YAML_TOP, YAML_CAMERA, YAML_ROI, YAML_MATRIX, YAML_OTHER };

#define DEPTH_MAX 16

/* ---- lines ---- */

/* Reads the next line that is neither blank nor a comment; false at the end of the file or, after
 * the first key, of the document. */
static bool next_line(struct yaml_reader *r)
{
	if (r->held) {
		r->held = false;
		return true;
	}
	while (!r->ended && (r->err = text_file_next(&r->file, r->words->fault)) > 0) {
		char *text = r->file.line;
		size_t length = strlen(text);

		r->err = 0;
		while (length && strchr(" \t\r", text[length - 1]))
			length--;
		text[length] = '\0';
		r->ended = r->begun && !strcmp(text, "---");
		if (length && text[strspn(text, " \t")] != '#' && text[0] != '%' &&
		    strcmp(text, "---") && strcmp(text, "..."))
			return true;
	}
	return false;
}

static bool is_indented(const struct yaml_reader *r)
{
	return r->file.line[0] == ' ' || r->file.line[0] == '\t';
}

/* The line without its indentation. */
static char *content_of(const struct yaml_reader *r)
{
	return r->file.line + strspn(r->file.line, " \t");
}

/* Splits "  key: rest"; false: the line has no key. */
static bool split_line(char *line, char **key, char **rest)
{
	char *colon;

	*key = line + strspn(line, " \t");
	colon = strchr(*key, ':');
	if (!colon || (colon[1] && !strchr(" \t", colon[1])))
		return false;
	*colon = '\0';
	*rest = colon + 1 + strspn(colon + 1, " \t");
	return true;
}

static int yaml_fault(const struct yaml_reader *r, const char *key, const char *expected)
{
	return words_fault(r->words, r->file.number, key, expected);
}

/* ---- values ---- */

/* Reads the numbers of a list up to its closing bracket, which may be lines below. */
static int read_list(struct yaml_reader *r, const char *text, struct words_matrix *m)
{
	int err = 0;

	for (text++;; text = r->file.line) {
		err = words_numbers(r->words, r->file.number, &text, ']', m);
		if (err || *text == ']')
			return err;
		if (!next_line(r))
			return r->err ? r->err
				      : yaml_fault(r, m->key,
						   "] after its numbers, not the file's end");
	}
}

/* Reads lines "- number" or "- [ numbers ]". */
static int read_items(struct yaml_reader *r, struct words_matrix *m)
{
	int err = 0;

	while (!err && next_line(r)) {
		const char *text = content_of(r);

		if (*text != '-' || (text[1] && !strchr(" \t", text[1]))) {
			r->held = true;
			return 0;
		}
		/* rows of a matrix are items of items */
		while (*text == '-' && (!text[1] || strchr(" \t", text[1])))
			text += 1 + strspn(text + 1, " \t");
		err = *text == '[' ? read_list(r, text, m)
				   : words_numbers(r->words, r->file.number, &text, '\0', m);
	}
	return err ? err : r->err;
}

static int read_member(struct yaml_reader *r, const char *name, const char *text,
		       struct words_matrix *m)
{
	if (!strcmp(name, "rows"))
		return words_int(r->words, r->file.number, m->key, text, 1, WORDS_DATA_MAX,
				 &m->rows);
	if (!strcmp(name, "cols"))
		return words_int(r->words, r->file.number, m->key, text, 1, WORDS_DATA_MAX,
				 &m->columns);
	return 0;
}

/* Reads rows, cols and data. */
static int read_block(struct yaml_reader *r, struct words_matrix *m)
{
	int err = 0;

	while (!err && next_line(r)) {
		char *name, *rest;

		if (!is_indented(r)) {
			r->held = true;
			break;
		}
		if (!split_line(r->file.line, &name, &rest))
			return yaml_fault(r, m->key, "rows, cols and data");
		if (strcmp(name, "data") != 0)
			err = read_member(r, name, rest, m);
		else
			err = *rest == '[' ? read_list(r, rest, m)
					   : yaml_fault(r, m->key, "data: [ numbers ]");
	}
	return err ? err : r->err;
}

static int read_matrix(struct yaml_reader *r, const char *key, const char *after,
		       struct words_matrix *m)
{
	int err = words_begin(r->words, r->file.number, key, m);
	bool list = *after == '[';

	if (!err && list) {
		err = read_list(r, after, m);
	} else if (!err && m == &r->words->xi && *after && *after != '!') {
		list = true;
		err = words_numbers(r->words, r->file.number, &after, '\0', m);
	} else if (!err) {
		if (*after && *after != '!' && *after != '#')
			return yaml_fault(r, key,
					  "rows, cols and data on lines of their own below it");
		r->held = next_line(r);
		list = r->held && *content_of(r) == '-';
		err = r->err ? r->err : list ? read_items(r, m) : read_block(r, m);
	}
	return err ? err : words_end(r->words, m, list);
}

static void read_text(const struct yaml_reader *r, const char *from, struct words_text *to)
{
	const char quote = *from == '"' || *from == '\'' ? *from : '\0';
	const char ends[] = {quote ? quote : '#', '\0'};
	size_t length;

	from += quote != '\0';
	length = strcspn(from, ends);
	while (length && !quote && strchr(" \t", from[length - 1]))
		length--;
	snprintf(to->text, sizeof(to->text), "%.*s", (int)length, from);
	to->line = r->file.number;
}

/* Remembers what says that the picture is not all that the matrix is of. */
static void note_part(struct yaml_reader *r, int block, const char *key, const char *rest)
{
	const int most = block == YAML_TOP && !strncmp(key, "binning_", 8) ? 1
			 : block == YAML_ROI && strstr(key, "_offset")	   ? 0
									   : INT_MAX;

	if (atoi(rest) > most && !r->words->part.line)
		read_text(r, key, &r->words->part);
}

/* ---- values in braces ---- */

static int flow_map(struct yaml_reader *r, int block, struct words_matrix *m, const char **at);

/* Moves to the next character that is no blank, perhaps lines below. */
static int flow_next(struct yaml_reader *r, const char **at)
{
	*at += strspn(*at, " \t");
	while (!**at || **at == '#') {
		if (!next_line(r))
			return r->err ? r->err
				      : words_fault(r->words, r->file.number, "{",
						    "} or ] before the end");
		*at = r->file.line + strspn(r->file.line, " \t");
	}
	return 0;
}

/* Takes a word, perhaps in quotes, up to one of these characters. */
static void flow_word(const char **at, const char *ends, char word[WORDS_NAME_MAX])
{
	const char quote[] = {**at, '\0'};
	const bool quoted = **at == '"' || **at == '\'';
	size_t length = strcspn(*at += quoted, quoted ? quote : ends);
	const char *from = *at;

	*at += length + (quoted && from[length]);
	while (length && !quoted && strchr(" \t", from[length - 1]))
		length--;
	snprintf(word, WORDS_NAME_MAX, "%.*s", (int)length, from);
}

/* Reads a list, of lists too, into a matrix; NULL: skips it. */
static int flow_list(struct yaml_reader *r, struct words_matrix *m, const char **at)
{
	char word[WORDS_NAME_MAX];
	int open = 0, err = 0;

	do {
		err = flow_next(r, at);
		if (err)
			return err;
		if (strchr("[],", **at))
			open += (**at == '[') - (**at == ']'), ++*at;
		else if (**at == '{')
			err = flow_map(r, YAML_OTHER, NULL, at);
		else if (m)
			err = words_numbers(r->words, r->file.number, at, ']', m);
		else
			flow_word(at, ",[]{}", word);
		if (!err && open > 0 && **at == '}')
			err = yaml_fault(r, m ? m->key : "[", "] before }");
	} while (!err && open > 0);
	return err;
}

static int flow_scalar(struct yaml_reader *r, int block, struct words_matrix *m, const char *key,
		       const char *text)
{
	const struct words_place place = words_place(r->words, key);
	int err;

	if (block == YAML_MATRIX)
		return read_member(r, key, text, m);
	note_part(r, block, key, text);
	if (block != YAML_TOP)
		return 0;
	if (place.kind == WORDS_INT)
		return words_int(r->words, r->file.number, key, text, place.least, place.most,
				 place.number);
	if (place.kind == WORDS_TEXT)
		read_text(r, text, place.text);
	if (place.kind != WORDS_MATRIX)
		return 0;
	err = words_begin(r->words, r->file.number, key, place.matrix);
	if (!err)
		err = words_numbers(r->words, r->file.number, &text, '\0', place.matrix);
	return err ? err : words_end(r->words, place.matrix, true);
}

/* Reads the value of a key. m: the matrix whose member it is. */
static int flow_value(struct yaml_reader *r, int block, struct words_matrix *m, const char *key,
		      const char **at)
{
	const struct words_place place = words_place(r->words, key);
	struct words_matrix *own = block == YAML_TOP && place.kind == WORDS_MATRIX ? place.matrix
										   : NULL;
	const bool list = **at == '[';
	char word[WORDS_NAME_MAX];
	int err = 0;

	if (!list && **at != '{') {
		flow_word(at, ",[]{}", word);
		return flow_scalar(r, block, m, key, word);
	}
	if (own)
		err = words_begin(r->words, r->file.number, key, own);
	if (err)
		return err;
	if (list)
		err = flow_list(r, block == YAML_MATRIX && !strcmp(key, "data") ? m : own, at);
	else
		err = flow_map(r,
			       own			 ? YAML_MATRIX
			       : strcmp(key, "roi") != 0 ? YAML_OTHER
							 : YAML_ROI,
			       own, at);
	return err || !own ? err : words_end(r->words, own, list);
}

static int flow_map(struct yaml_reader *r, int block, struct words_matrix *m, const char **at)
{
	char key[WORDS_NAME_MAX];
	int err = 0;

	if (++r->depth > DEPTH_MAX)
		return yaml_fault(r, "{", "fewer braces in each other");
	for (++*at; !err;) {
		err = flow_next(r, at);
		if (err || **at == '}')
			break;
		if (**at == ',') {
			++*at;
			continue;
		}
		flow_word(at, ":,[]{}", key);
		err = flow_next(r, at);
		if (!err && **at != ':')
			return yaml_fault(r, key, "a colon and a value");
		++*at;
		if (!err)
			err = flow_next(r, at);
		if (!err)
			err = flow_value(r, block, m, key, at);
	}
	*at += !err;
	r->depth--;
	return err;
}

/* ---- keys ---- */

static int read_key(struct yaml_reader *r, const char *key, const char *rest)
{
	const struct words_place place = words_place(r->words, key);
	char kept[WORDS_NAME_MAX];

	/* the line that holds the key goes as soon as the next one is read */
	snprintf(kept, sizeof(kept), "%s", key);
	if (*rest == '{')
		return flow_value(r, YAML_TOP, NULL, kept, &rest);
	switch (place.kind) {
	case WORDS_MATRIX:
		return read_matrix(r, kept, rest, place.matrix);
	case WORDS_INT:
		return words_int(r->words, r->file.number, key, rest, place.least, place.most,
				 place.number);
	case WORDS_TEXT:
		read_text(r, rest, place.text);
		return 0;
	default:
		return 0;
	}
}

/* ---- blocks ---- */

/* Whether a key is the name of one of Kalibr's cameras: cam0, cam1 ... */
static bool is_camera(const char *key)
{
	return !strncmp(key, "cam", 3) && key[3] && !key[3 + strspn(key + 3, "0123456789")];
}

static void begin_camera(struct yaml_reader *r, const char *key)
{
	struct lens_words *w = r->words;
	struct words_text *name = w->first.line ? &w->second : &w->first;
	const bool wanted = w->camera ? !strcmp(w->camera, key) : !w->first.line;

	if (!name->line)
		read_text(r, key, name);
	r->block = wanted ? YAML_CAMERA : YAML_OTHER;
	w->chosen |= wanted;
}

/* A key in the first column. */
static int read_top(struct yaml_reader *r, const char *key, const char *rest)
{
	r->begun = true;
	r->block = YAML_TOP;
	snprintf(r->top, sizeof(r->top), "%s", key);
	note_part(r, r->block, key, rest);
	if (is_camera(key) && !*rest)
		begin_camera(r, key);
	else if (!strcmp(key, "roi") && !*rest)
		r->block = YAML_ROI;
	else
		return read_key(r, key, rest);
	return 0;
}

static int read_line(struct yaml_reader *r)
{
	const char *at = content_of(r);
	char *key, *rest;

	if (*at == '{' && !r->begun) {
		r->begun = true;
		return flow_map(r, YAML_TOP, NULL, &at);
	}
	/* part of an unknown key */
	if (strchr("-[]", *content_of(r)))
		return 0;
	/* Kalibr's cameras may have other names, and ROS's parameters that of a node. */
	if (is_indented(r) && *r->top && r->block != YAML_CAMERA &&
	    (!strncmp(at, "camera_model:", 13) || !strncmp(at, "image_width:", 12)))
		begin_camera(r, r->top);
	if (is_indented(r) && r->block != YAML_CAMERA && r->block != YAML_ROI)
		return 0;
	if (!split_line(r->file.line, &key, &rest))
		return is_indented(r)
			       ? 0
			       : yaml_fault(r, r->file.line,
					    "KEY: VALUE, as OpenCV, ROS and Kalibr write lenses");
	if (key == r->file.line)
		return read_top(r, key, rest);
	if (r->block == YAML_CAMERA)
		return read_key(r, key, rest);
	note_part(r, r->block, key, rest);
	return 0;
}

int words_read_yaml(struct lens_words *words)
{
	struct yaml_reader r = {.words = words};
	int err = text_file_open(&r.file, words->path, words->fault);

	if (err)
		return err;
	while (!err && next_line(&r))
		err = read_line(&r);
	if (!err)
		err = r.err;
	text_file_close(&r.file);
	return err;
}
