/* SPDX-License-Identifier: MIT */
/* Reader of the XML of OpenCV's FileStorage: elements below opencv_storage are the keys, a matrix
 * is one with the elements rows, cols and data. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "bake/calibrate/convert/convert_words.h"
#include "hal/base/text_file.h"

#define DEPTH_MAX 8

struct xml_reader {
	struct text_file file;
	struct lens_words *words;
	const char *at; /* rest of the line */
	int depth;	/* of open elements */
	char name[DEPTH_MAX][WORDS_NAME_MAX];
	int line[DEPTH_MAX];	     /* where they began */
	struct words_matrix *matrix; /* the open one; NULL: none */
	char text[WORDS_NAME_MAX];   /* of the open element, if it is short */
	bool comment;
};

static int xml_fault(const struct xml_reader *r, const char *what, const char *expected)
{
	return words_fault(r->words, r->file.number, what, expected);
}

/* The element at depth 1 is the key; those below it are a matrix's. */
static int open_element(struct xml_reader *r, const char *name)
{
	struct words_place place;

	if (r->depth == DEPTH_MAX)
		return xml_fault(r, name, "fewer elements in each other");
	snprintf(r->name[r->depth], sizeof(r->name[0]), "%s", name);
	r->line[r->depth] = r->file.number;
	r->text[0] = '\0';
	if (!r->depth && strcmp(name, "opencv_storage") != 0)
		return xml_fault(r, name, "<opencv_storage>, as OpenCV writes XML");
	if (r->depth++ != 1)
		return 0;
	place = words_place(r->words, name);
	r->matrix = place.kind == WORDS_MATRIX ? place.matrix : NULL;
	return r->matrix ? words_begin(r->words, r->file.number, name, r->matrix) : 0;
}

/* Ends a matrix: rows, cols and data, or numbers alone, as of a size. */
static int close_matrix(struct xml_reader *r)
{
	struct words_matrix *m = r->matrix;

	r->matrix = NULL;
	return words_end(r->words, m, !m->rows && !m->columns);
}

static int close_key(struct xml_reader *r, const char *name)
{
	const struct words_place place = words_place(r->words, name);
	const char *text = r->text + strspn(r->text, " \t\"");

	if (place.kind == WORDS_MATRIX)
		return close_matrix(r);
	if (place.kind == WORDS_INT)
		return words_int(r->words, r->line[1], name, text, place.least, place.most,
				 place.number);
	if (place.kind == WORDS_TEXT) {
		snprintf(place.text->text, sizeof(place.text->text), "%.*s",
			 (int)strcspn(text, "\""), text);
		place.text->line = r->line[1];
	}
	return 0;
}

static int close_element(struct xml_reader *r, const char *name)
{
	int err = 0;

	if (!r->depth || strcmp(r->name[r->depth - 1], name) != 0)
		return xml_fault(r, name, "the end of the element that began last");
	if (r->depth == 2)
		err = close_key(r, name);
	else if (r->depth == 3 && r->matrix && !strcmp(name, "rows"))
		err = words_int(r->words, r->file.number, r->matrix->key, r->text, 1,
				WORDS_DATA_MAX, &r->matrix->rows);
	else if (r->depth == 3 && r->matrix && !strcmp(name, "cols"))
		err = words_int(r->words, r->file.number, r->matrix->key, r->text, 1,
				WORDS_DATA_MAX, &r->matrix->columns);
	r->depth--;
	r->text[0] = '\0';
	return err;
}

/* Whether the text of the open element is a matrix's numbers. */
static bool is_data(const struct xml_reader *r)
{
	return r->matrix && (r->depth == 2 || (r->depth == 3 && !strcmp(r->name[2], "data")));
}

/* Text up to the next element or the line's end. */
static int read_text(struct xml_reader *r)
{
	const size_t length = strcspn(r->at, "<"), before = strlen(r->text);
	int err = 0;

	if (is_data(r)) {
		err = words_numbers(r->words, r->file.number, &r->at, '<', r->matrix);
		if (!err && *r->at == '#')
			err = xml_fault(r, r->matrix->key, "finite numbers");
		return err;
	}
	if (before + length < sizeof(r->text))
		snprintf(r->text + before, sizeof(r->text) - before, "%.*s", (int)length, r->at);
	r->at += length;
	return 0;
}

/* <name attributes>, </name>, <name/>, <?xml ...?>, or the beginning of a comment. */
static int read_tag(struct xml_reader *r)
{
	const char *from = r->at + 1, *end = strchr(from, '>');
	char name[WORDS_NAME_MAX];
	int err;

	if (!strncmp(r->at, "<!--", 4)) {
		r->comment = true;
		return 0;
	}
	if (!end)
		return xml_fault(r, "<", "> on the same line");
	r->at = end + 1;
	if (*from == '?')
		return 0;
	snprintf(name, sizeof(name), "%.*s", (int)strcspn(from + (*from == '/'), " \t/>"),
		 from + (*from == '/'));
	if (*from == '/')
		return close_element(r, name);
	err = open_element(r, name);
	return err || end[-1] != '/' ? err : close_element(r, name);
}

static int read_xml_line(struct xml_reader *r)
{
	int err = 0;

	r->file.line[strcspn(r->file.line, "\r")] = '\0';
	r->at = r->file.line;
	while (!err && *r->at) {
		if (r->comment) {
			const char *end = strstr(r->at, "-->");

			r->comment = !end;
			r->at = end ? end + 3 : "";
		} else {
			err = *r->at == '<' ? read_tag(r) : read_text(r);
		}
	}
	return err;
}

int words_read_xml(struct lens_words *words)
{
	struct xml_reader r = {.words = words};
	int err = text_file_open(&r.file, words->path, words->fault);

	if (err)
		return err;
	while (!err && (err = text_file_next(&r.file, words->fault)) > 0)
		err = read_xml_line(&r);
	if (!err && r.depth)
		err = xml_fault(&r, r.name[r.depth - 1], "its end before the file's");
	text_file_close(&r.file);
	return err;
}
