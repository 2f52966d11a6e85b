/* SPDX-License-Identifier: MIT */
/*
 * Reader of the part of YAML in which OpenCV and ROS write lenses: keys in the first column,
 * matrices as blocks of rows, cols and data below them. Unknown keys are ignored; known ones must
 * be complete.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/convert/convert.h"
#include "hal/base/number.h"
#include "hal/base/text_file.h"

#define DATA_MAX 16 /* numbers of the largest matrix */

struct yaml_matrix {
	int line; /* line of its key; 0: not there */
	int rows, columns, count;
	double data[DATA_MAX];
};

struct yaml_reader {
	struct text_file file;
	bool held; /* next_line() returns the current line again */
	/* why there is no next line, other than the end of the file; the fault says it */
	int err;
	struct fault *fault;
};

/* Values of a file's keys. */
struct spoken {
	struct yaml_matrix camera, distortion;
	int width, height, fisheye; /* -1: not given */
	char model[64];
	int model_line;
};

/* ---- lines ---- */

/* Reads the next line that is neither blank nor a comment; false at the end. */
static bool next_line(struct yaml_reader *r)
{
	if (r->held) {
		r->held = false;
		return true;
	}
	while ((r->err = text_file_next(&r->file, r->fault)) > 0) {
		char *text = r->file.line;
		size_t length = strlen(text);

		r->err = 0;
		while (length && strchr(" \t\r", text[length - 1]))
			length--;
		text[length] = '\0';
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
	return fault_say(r->fault, -EINVAL, "%s:%d: %s: expected %s", r->file.path, r->file.number,
			 key, expected);
}

/* ---- values ---- */

static int read_int(const struct yaml_reader *r, const char *key, const char *text, int least,
		    int most, int *value)
{
	char *end, expected[64];
	long n;

	errno = 0;
	n = strtol(text, &end, 10);
	if (!errno && end != text && !end[strspn(end, " \t")] && n >= least && n <= most) {
		*value = (int)n;
		return 0;
	}
	snprintf(expected, sizeof(expected), "a whole number from %d to %d", least, most);
	return yaml_fault(r, key, expected);
}

/* Reads the numbers of a line up to its end or to the closing bracket, which sets *whole. */
static int read_numbers(const struct yaml_reader *r, const char *key, const char *text,
			struct yaml_matrix *m, bool *whole)
{
	for (;;) {
		double value;

		text += strspn(text, " \t,");
		if (!*text || *text == '#')
			return 0;
		if (*text == ']') {
			*whole = true;
			return 0;
		}
		if (number_read(&text, &value) || (*text && !strchr(" \t,]", *text)))
			return yaml_fault(r, key, "finite numbers between [ and ]");
		if (m->count == DATA_MAX)
			return yaml_fault(r, key, "fewer numbers");
		m->data[m->count++] = value;
	}
}

static int read_data(struct yaml_reader *r, const char *key, char *text, struct yaml_matrix *m)
{
	bool whole = false;
	int err;

	if (*text != '[')
		return yaml_fault(r, key, "data: [ numbers ]");
	err = read_numbers(r, key, text + 1, m, &whole);
	while (!err && !whole) {
		if (!next_line(r))
			return r->err ? r->err
				      : yaml_fault(r, key,
						   "] after its numbers, not the file's end");
		err = read_numbers(r, key, r->file.line, m, &whole);
	}
	return err;
}

/* Reads the block below a key. */
static int read_matrix(struct yaml_reader *r, const char *key, const char *after,
		       struct yaml_matrix *m)
{
	int err = 0;

	if (m->line)
		return yaml_fault(r, key, "to be there once");
	*m = (struct yaml_matrix){.line = r->file.number};
	if (*after && *after != '!' && *after != '#')
		return yaml_fault(r, key, "rows, cols and data on lines of their own below it");
	while (!err && next_line(r)) {
		char *name, *rest;

		if (!is_indented(r)) {
			r->held = true;
			break;
		}
		if (!split_line(r->file.line, &name, &rest))
			return yaml_fault(r, key, "rows, cols and data");
		if (!strcmp(name, "rows"))
			err = read_int(r, key, rest, 1, DATA_MAX, &m->rows);
		else if (!strcmp(name, "cols"))
			err = read_int(r, key, rest, 1, DATA_MAX, &m->columns);
		else if (!strcmp(name, "data"))
			err = read_data(r, key, rest, m);
	}
	if (!err)
		err = r->err;
	if (!err && (!m->count || m->count != m->rows * m->columns))
		return fault_say(r->fault, -EINVAL,
				 "%s:%d: %s: has %d rows, %d columns and %d numbers, expected as "
				 "many as rows times columns",
				 r->file.path, m->line, key, m->rows, m->columns, m->count);
	return err;
}

static void read_yaml_text(const char *from, char *text, size_t room)
{
	const char quote = *from == '"' || *from == '\'' ? *from : '\0';
	const char ends[] = {quote ? quote : '#', '\0'};
	size_t length;

	from += quote != '\0';
	length = strcspn(from, ends);
	while (length && !quote && strchr(" \t", from[length - 1]))
		length--;
	snprintf(text, room, "%.*s", (int)length, from);
}

static int read_key(struct yaml_reader *r, const char *key, const char *rest, struct spoken *s)
{
	if (!strcmp(key, "camera_matrix"))
		return read_matrix(r, "camera_matrix", rest, &s->camera);
	if (!strcmp(key, "distortion_coefficients"))
		return read_matrix(r, "distortion_coefficients", rest, &s->distortion);
	if (!strcmp(key, "image_width"))
		return read_int(r, key, rest, 1, TSAI_SIDE_MAX, &s->width);
	if (!strcmp(key, "image_height"))
		return read_int(r, key, rest, 1, TSAI_SIDE_MAX, &s->height);
	if (!strcmp(key, "fisheye_model"))
		return read_int(r, key, rest, 0, 1, &s->fisheye);
	if (!strcmp(key, "distortion_model")) {
		read_yaml_text(rest, s->model, sizeof(s->model));
		s->model_line = r->file.number;
	}
	return 0;
}

static int read_keys(struct yaml_reader *r, struct spoken *s)
{
	int err = 0;

	while (!err && next_line(r)) {
		char *key, *rest;

		/* part of an unknown key */
		if (is_indented(r) || r->file.line[0] == '-' || r->file.line[0] == ']')
			continue;
		if (!split_line(r->file.line, &key, &rest))
			return yaml_fault(r, r->file.line,
					  "KEY: VALUE, as OpenCV and ROS write lenses");
		err = read_key(r, key, rest, s);
	}
	return err ? err : r->err;
}

/* ---- what they mean ---- */

static int take_camera(struct lens *lens, const struct yaml_reader *r, const struct yaml_matrix *m)
{
	const double *k = m->data;

	if (!m->line)
		return fault_say(r->fault, -EINVAL, "%s: has no camera_matrix", r->file.path);
	if (m->rows != 3 || m->columns != 3 || !(k[0] > 0) || !(k[4] > 0) || k[3] != 0 ||
	    k[6] != 0 || k[7] != 0 || k[8] != 1)
		return fault_say(r->fault, -EINVAL,
				 "%s:%d: camera_matrix: expected fx 0 cx, 0 fy cy, 0 0 1 with fx "
				 "and fy above 0",
				 r->file.path, m->line);
	if (k[1] != 0)
		return fault_say(r->fault, -EINVAL,
				 "%s:%d: camera_matrix: a skew of %g, expected 0: rows and columns "
				 "of pixels are at right angles here",
				 r->file.path, m->line, k[1]);
	lens->focal_px[0] = k[0];
	lens->focal_px[1] = k[4];
	lens->centre_px[0] = k[2] + 0.5;
	lens->centre_px[1] = k[5] + 0.5;
	return 0;
}

static int take_model(struct lens *lens, const struct yaml_reader *r, const struct spoken *s)
{
	if (s->fisheye >= 0)
		lens->fisheye = s->fisheye == 1;
	if (!s->model_line)
		return 0;
	lens->fisheye = !strcmp(s->model, "equidistant") || !strcmp(s->model, "fisheye");
	if (lens->fisheye || !strcmp(s->model, "plumb_bob") ||
	    !strcmp(s->model, "rational_polynomial"))
		return 0;
	return fault_say(r->fault, -EINVAL,
			 "%s:%d: distortion_model: %s, expected plumb_bob, rational_polynomial or "
			 "equidistant",
			 r->file.path, s->model_line, s->model);
}

static int take_distortion(struct lens *lens, const struct yaml_reader *r,
			   const struct yaml_matrix *m)
{
	const int most = lens->fisheye ? FISHEYE_TERMS : LENS_TERMS;

	if (!m->line)
		return fault_say(r->fault, -EINVAL, "%s: has no distortion_coefficients",
				 r->file.path);
	if ((m->rows != 1 && m->columns != 1) || (lens->fisheye && m->count != FISHEYE_TERMS))
		return fault_say(r->fault, -EINVAL,
				 "%s:%d: distortion_coefficients: %d x %d of them, expected one "
				 "row%s",
				 r->file.path, m->line, m->rows, m->columns,
				 lens->fisheye ? " of 4" : "");
	for (int k = 0; k < m->count; k++) {
		if (k < most)
			lens->term[k] = m->data[k];
		else if (m->data[k] != 0)
			return fault_say(
				r->fault, -EINVAL,
				"%s:%d: distortion_coefficients: number %d is %g, expected "
				"0: neither thin prisms nor tilted sensors are known here",
				r->file.path, m->line, k + 1, m->data[k]);
	}
	return 0;
}

static int take_size(struct lens *lens, const struct yaml_reader *r, const struct spoken *s)
{
	lens->width = s->width > 0 ? s->width : lens->width;
	lens->height = s->height > 0 ? s->height : lens->height;
	if (lens->width > 0 && lens->height > 0)
		return 0;
	return fault_say(r->fault, -EINVAL,
			 "%s: has no image_width and image_height, expected them here or by --size",
			 r->file.path);
}

int lens_read_yaml(struct lens *lens, const char *path, struct fault *fault)
{
	struct yaml_reader r = {.fault = fault};
	struct spoken s = {.width = -1, .height = -1, .fisheye = -1};
	int err = text_file_open(&r.file, path, fault);

	if (err)
		return err;
	err = read_keys(&r, &s);
	if (!err)
		err = take_size(lens, &r, &s);
	if (!err)
		err = take_camera(lens, &r, &s.camera);
	if (!err)
		err = take_model(lens, &r, &s);
	if (!err)
		err = take_distortion(lens, &r, &s.distortion);
	text_file_close(&r.file);
	return err;
}
