/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh_ply.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "bake/mesh/plain_file.h"

#define HEADER_BYTES_MAX (1 << 20)
#define ELEMENTS_MAX 32
#define PROPERTIES_MAX 512
#define SHOWN_MAX 32 /* characters of a word that a fault quotes */

/* ---- words ---- */

struct ply_span {
	const char *at, *end;
};

static bool ply_is_line_end(char c)
{
	return c == '\n' || c == '\r';
}

static bool ply_is_blank(char c)
{
	return c == ' ' || c == '\t';
}

static struct ply_span ply_take_word(struct ply_span *line)
{
	struct ply_span word;

	while (line->at < line->end && ply_is_blank(*line->at))
		line->at++;
	word.at = line->at;
	while (line->at < line->end && !ply_is_blank(*line->at))
		line->at++;
	word.end = line->at;
	return word;
}

static int word_shown(struct ply_span word)
{
	return word.end - word.at < SHOWN_MAX ? (int)(word.end - word.at) : SHOWN_MAX;
}

static bool word_is(struct ply_span word, const char *text)
{
	const size_t length = (size_t)(word.end - word.at);

	return length == strlen(text) && memcmp(word.at, text, length) == 0;
}

/* Reads a whole number, 0..INT_MAX; -1: the word is none. */
static long whole_of(struct ply_span word)
{
	long value = 0;

	if (word.at == word.end)
		return -1;
	for (const char *c = word.at; c < word.end; c++) {
		if (*c < '0' || *c > '9')
			return -1;
		value = 10 * value + (*c - '0');
		if (value > INT_MAX)
			return -1;
	}
	return value;
}

static bool is_number(struct ply_span word)
{
	const size_t length = (size_t)(word.end - word.at);
	char text[64], *stop;

	if (!length || length >= sizeof(text))
		return false;
	memcpy(text, word.at, length);
	text[length] = '\0';
	strtod(text, &stop);
	return stop == text + length;
}

/* ---- the header ---- */

struct ply_type {
	const char *name, *other_name;
	int bytes;
	bool whole, sign;
};

static const struct ply_type types[] = {
	{"char", "int8", 1, true, true},	  {"uchar", "uint8", 1, true, false},
	{"short", "int16", 2, true, true},	  {"ushort", "uint16", 2, true, false},
	{"int", "int32", 4, true, true},	  {"uint", "uint32", 4, true, false},
	{"float", "float32", 4, false, true},	  {"double", "float64", 8, false, true},
	{"double64", "double64", 8, false, true},
};

struct ply_property {
	const struct ply_type *type, *count; /* count NULL: no list */
	bool corners;			     /* vertices of a face */
};

struct ply_element {
	struct ply_span name;
	int line, properties;
	size_t count;
	struct ply_property *property;
};

struct ply {
	const char *path;
	size_t bytes;
	struct ply_span rest; /* of the file */
	int line;	      /* number of the line that was taken last */
	bool ascii, big_endian;
	size_t vertices;
	int elements, properties;
	struct ply_element element[ELEMENTS_MAX];
	struct ply_property property[PROPERTIES_MAX];
};

/* Takes the next line. Skips empty ones, as assimp does. False at the end of the file. */
static bool ply_take_line(struct ply *ply, struct ply_span *line)
{
	struct ply_span *rest = &ply->rest;

	do {
		line->at = rest->at;
		while (rest->at < rest->end && !ply_is_line_end(*rest->at))
			rest->at++;
		line->end = rest->at;
		if (line->at == rest->end)
			return false;
		ply->line++;
		if (rest->at < rest->end)
			rest->at += rest->end - rest->at > 1 && !memcmp(rest->at, "\r\n", 2) ? 2
											     : 1;
	} while (line->at == line->end);
	return true;
}

/* Refuses text with NUL or form feed: on a line that ends in one of them assimp searches for its
 * end beyond the end of the file. */
static int check_text(const struct ply *ply, const char *at, const char *end, struct fault *fault)
{
	const size_t bytes = (size_t)(end - at);

	if (!memchr(at, '\0', bytes) && !memchr(at, '\f', bytes))
		return 0;
	return fault_say(fault, -EBADMSG,
			 "%s: bytes that are no text among it, expected none: damaged or cut short",
			 ply->path);
}

static int read_type(const struct ply *ply, struct ply_span *line, const struct ply_type **type,
		     struct fault *fault)
{
	const struct ply_span word = ply_take_word(line);

	for (size_t k = 0; k < sizeof(types) / sizeof(*types); k++)
		if (word_is(word, types[k].name) || word_is(word, types[k].other_name)) {
			*type = &types[k];
			return 0;
		}
	return fault_say(fault, -EBADMSG,
			 "%s:%d: property of type \"%.*s\", expected char, uchar, short, ushort, "
			 "int, uint, float or double",
			 ply->path, ply->line, word_shown(word), word.at);
}

/* Refuses a property after a line of another kind, as assimp drops it. */
static int read_property(struct ply *ply, struct ply_span line, bool in_element,
			 struct fault *fault)
{
	struct ply_property *property = &ply->property[ply->properties];
	struct ply_element *element;
	struct ply_span list = line, name;
	int err = 0;

	if (!in_element)
		return fault_say(fault, -EBADMSG,
				 "%s:%d: a property by itself, expected an element, or another "
				 "property of its, in the line before",
				 ply->path, ply->line);
	if (ply->properties == PROPERTIES_MAX)
		return fault_say(fault, -E2BIG, "%s:%d: expected at most %d properties", ply->path,
				 ply->line, PROPERTIES_MAX);
	*property = (struct ply_property){.type = NULL};
	element = &ply->element[ply->elements - 1];
	if (word_is(ply_take_word(&list), "list")) {
		line = list;
		err = read_type(ply, &line, &property->count, fault);
		if (!err && !property->count->whole)
			err = fault_say(fault, -EBADMSG,
					"%s:%d: a list counted in %s, expected whole numbers",
					ply->path, ply->line, property->count->name);
	}
	if (!err)
		err = read_type(ply, &line, &property->type, fault);
	if (err)
		return err;
	name = ply_take_word(&line);
	property->corners = property->count && word_is(element->name, "face") &&
			    (word_is(name, "vertex_indices") || word_is(name, "vertex_index"));
	ply->properties++;
	element->properties++;
	return 0;
}

static int read_element(struct ply *ply, struct ply_span line, struct fault *fault)
{
	const struct ply_span name = ply_take_word(&line), word = ply_take_word(&line);
	const long count = whole_of(word);

	if (count < 0)
		return fault_say(fault, -EBADMSG,
				 "%s:%d: element %.*s \"%.*s\", expected a number 0..%d", ply->path,
				 ply->line, word_shown(name), name.at, word_shown(word), word.at,
				 INT_MAX);
	if (ply->elements == ELEMENTS_MAX)
		return fault_say(fault, -E2BIG, "%s:%d: expected at most %d elements", ply->path,
				 ply->line, ELEMENTS_MAX);
	ply->element[ply->elements++] = (struct ply_element){
		.name = name,
		.line = ply->line,
		.count = (size_t)count,
		.property = &ply->property[ply->properties],
	};
	if (word_is(name, "vertex"))
		ply->vertices = (size_t)count;
	return 0;
}

static int read_format(struct ply *ply, struct fault *fault)
{
	struct ply_span line = {NULL, NULL}, format, kind;

	ply_take_line(ply, &line);
	format = ply_take_word(&line);
	kind = ply_take_word(&line);
	ply->ascii = word_is(kind, "ascii");
	ply->big_endian = word_is(kind, "binary_big_endian");
	if (word_is(format, "format") &&
	    (ply->ascii || ply->big_endian || word_is(kind, "binary_little_endian")))
		return 0;
	return fault_say(fault, -EBADMSG,
			 "%s:%d: expected format ascii, binary_little_endian or binary_big_endian "
			 "after ply",
			 ply->path, ply->line);
}

/* Refuses binary data that begin with a line end: assimp would skip it. */
static int check_start(const struct ply *ply, struct fault *fault)
{
	const char *at = ply->rest.at;

	if (ply->ascii || at == ply->rest.end || !ply_is_line_end(*at))
		return 0;
	return fault_say(
		fault, -ENOTSUP,
		"%s: its data begin with a byte of %d, which would be taken for the end of "
		"a line, expected another vertex first, or format ascii",
		ply->path, *at);
}

/* Reads the header's lines up to end_header. Skips lines of other kinds, such as comments. */
static int ply_read_lines(struct ply *ply, struct fault *fault)
{
	struct ply_span line, word;
	bool in_element = false;
	int err = 0;

	while (!err) {
		word = ply_take_line(ply, &line) ? ply_take_word(&line) : line;
		if (word_is(word, "end_header"))
			return 0;
		if (ply->rest.at == ply->rest.end)
			return fault_say(fault, -EBADMSG,
					 "%s: no line end_header, expected one at the end of the "
					 "header: damaged or cut short",
					 ply->path);
		if (word_is(word, "property")) {
			err = read_property(ply, line, in_element, fault);
			continue;
		}
		in_element = word_is(word, "element");
		if (in_element)
			err = read_element(ply, line, fault);
	}
	return err;
}

static int ply_read_header(struct ply *ply, struct fault *fault)
{
	const struct ply_span all = ply->rest;
	struct ply_span line;
	int err;

	if (all.end - all.at > HEADER_BYTES_MAX)
		ply->rest.end = all.at + HEADER_BYTES_MAX;
	ply_take_line(ply, &line); /* the word ply */
	err = read_format(ply, fault);
	if (!err)
		err = ply_read_lines(ply, fault);
	ply->rest.end = all.end;
	if (!err)
		err = check_text(ply, all.at, ply->ascii ? all.end : ply->rest.at, fault);
	return err ? err : check_start(ply, fault);
}

/* ---- rows ---- */

/* Returns the least bytes of a row. In text a value takes at least a digit and a separator. */
static size_t least_bytes(const struct ply *ply, const struct ply_element *element)
{
	size_t bytes = 0;

	for (int k = 0; k < element->properties; k++) {
		const struct ply_property *p = &element->property[k];

		bytes += ply->ascii ? 2 : (size_t)(p->count ? p->count->bytes : p->type->bytes);
	}
	return bytes;
}

static int check_counts(const struct ply *ply, struct fault *fault)
{
	/* the last value of a text needs no separator */
	const size_t room = (size_t)(ply->rest.end - ply->rest.at) + ply->ascii;
	size_t used = 0;

	for (int k = 0; k < ply->elements; k++) {
		const struct ply_element *e = &ply->element[k];

		if (e->count && !e->properties)
			return fault_say(fault, -EBADMSG,
					 "%s:%d: element %.*s has no property, expected at least "
					 "one",
					 ply->path, e->line, word_shown(e->name), e->name.at);
		used += e->count * least_bytes(ply, e);
		if (used > room)
			return fault_say(fault, -EBADMSG,
					 "%s:%d: element %.*s %zu, but a file of %zu bytes cannot "
					 "hold them",
					 ply->path, e->line, word_shown(e->name), e->name.at,
					 e->count, ply->bytes);
	}
	return 0;
}

static int say_cut(const struct ply *ply, const struct ply_element *element, size_t row,
		   struct fault *fault)
{
	return fault_say(fault, -EBADMSG,
			 "%s: it ends in %.*s %zu, expected %zu of them: damaged or cut short",
			 ply->path, word_shown(element->name), element->name.at, row + 1,
			 element->count);
}

static int check_corner(const struct ply *ply, struct ply_span word, size_t row,
			struct fault *fault)
{
	const long corner = whole_of(word);

	if (corner >= 0 && (size_t)corner < ply->vertices)
		return 0;
	return fault_say(fault, -EBADMSG,
			 "%s:%d: face %zu names vertex %.*s, expected less than %zu: damaged or "
			 "cut short",
			 ply->path, ply->line, row + 1, word_shown(word), word.at, ply->vertices);
}

static int say_value(const struct ply *ply, const struct ply_element *element, size_t row,
		     struct ply_span word, const char *expected, struct fault *fault)
{
	if (word.at == word.end)
		return fault_say(fault, -EBADMSG,
				 "%s:%d: %.*s %zu ends here, expected %s: damaged or cut short",
				 ply->path, ply->line, word_shown(element->name), element->name.at,
				 row + 1, expected);
	return fault_say(fault, -EBADMSG,
			 "%s:%d: %.*s %zu has \"%.*s\", expected %s: damaged or cut short",
			 ply->path, ply->line, word_shown(element->name), element->name.at, row + 1,
			 word_shown(word), word.at, expected);
}

static int check_values(const struct ply *ply, const struct ply_element *element,
			const struct ply_property *property, struct ply_span *line, size_t row,
			struct fault *fault)
{
	struct ply_span word;
	long count = 1;

	if (property->count) {
		word = ply_take_word(line);
		count = whole_of(word);
		if (count < property->corners)
			return say_value(ply, element, row, word, "how many numbers follow", fault);
	}
	for (long k = 0; k < count; k++) {
		word = ply_take_word(line);
		if (!is_number(word))
			return say_value(ply, element, row, word, "a number", fault);
		if (property->corners && check_corner(ply, word, row, fault) < 0)
			return -EBADMSG;
	}
	return 0;
}

static int check_text_row(struct ply *ply, const struct ply_element *element, size_t row,
			  struct fault *fault)
{
	struct ply_span line, word;
	bool corners = false;
	int err = 0;

	if (!ply_take_line(ply, &line))
		return say_cut(ply, element, row, fault);
	for (int k = 0; k < element->properties && !err; k++) {
		corners |= element->property[k].corners;
		err = check_values(ply, element, &element->property[k], &line, row, fault);
	}
	if (err || !corners)
		return err;
	word = ply_take_word(&line);
	if (word.at == word.end)
		return 0;
	return fault_say(fault, -EBADMSG,
			 "%s:%d: face %zu has \"%.*s\" after its vertices, expected as many as it "
			 "counts",
			 ply->path, ply->line, row + 1, word_shown(word), word.at);
}

/* Reads the count of a binary list; -1: it is negative. */
static int64_t count_of(const char *at, const struct ply_type *type, bool big_endian)
{
	const int bits = 8 * type->bytes;
	uint64_t value = 0;

	for (int k = 0; k < type->bytes; k++)
		value |= (uint64_t)(uint8_t)at[k] << 8 * (big_endian ? type->bytes - 1 - k : k);
	return type->sign && value >> (bits - 1) ? -1 : (int64_t)value;
}

static int check_binary_row(struct ply *ply, const struct ply_element *element, size_t row,
			    struct fault *fault)
{
	for (int k = 0; k < element->properties; k++) {
		const struct ply_property *p = &element->property[k];
		int64_t count = 1;

		if (p->count) {
			if (ply->rest.end - ply->rest.at < p->count->bytes)
				return say_cut(ply, element, row, fault);
			count = count_of(ply->rest.at, p->count, ply->big_endian);
			ply->rest.at += p->count->bytes;
			if (count < p->corners)
				return fault_say(fault, -EBADMSG,
						 "%s: %.*s %zu has a list of %lld, expected more",
						 ply->path, word_shown(element->name),
						 element->name.at, row + 1, (long long)count);
		}
		if (ply->rest.end - ply->rest.at < count * p->type->bytes)
			return say_cut(ply, element, row, fault);
		ply->rest.at += count * p->type->bytes;
	}
	return 0;
}

static int check_rows(struct ply *ply, struct fault *fault)
{
	int err = 0;

	for (int k = 0; k < ply->elements && !err; k++) {
		const struct ply_element *e = &ply->element[k];

		for (size_t row = 0; row < e->count && !err; row++)
			err = ply->ascii ? check_text_row(ply, e, row, fault)
					 : check_binary_row(ply, e, row, fault);
	}
	return err;
}

/* ---- the file ---- */

static int ply_check(const char *text, size_t bytes, const char *path, struct fault *fault)
{
	const char *magic = text, *const end = text + bytes;
	struct ply *ply;
	int err;

	/* assimp also reads a PLY that begins with empty lines */
	while (magic < end && ply_is_line_end(*magic))
		magic++;
	if (end - magic < 3 || strncasecmp(magic, "ply", 3) != 0)
		return 0;
	ply = calloc(1, sizeof(*ply));
	if (!ply)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	ply->path = path;
	ply->bytes = bytes;
	ply->rest = (struct ply_span){text, end};
	err = ply_read_header(ply, fault);
	if (!err)
		err = check_counts(ply, fault);
	if (!err)
		err = check_rows(ply, fault);
	free(ply);
	return err;
}

int mesh_ply_check(const char *path, struct fault *fault)
{
	struct plain_map file;
	int err = plain_file_map(&file, path, PLAIN_FILE_MAX, fault);

	if (err)
		return err;
	err = ply_check(file.at, file.bytes, path, fault);
	plain_file_unmap(&file);
	return err;
}
