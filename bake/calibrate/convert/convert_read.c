/* SPDX-License-Identifier: MIT */
/* Reads the lenses of OpenCV, ROS and Kalibr: YAML, or JSON, which is YAML; or says in a
 * sentence why a file holds none of ours. */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#include "bake/calibrate/convert/convert.h"
#include "hal/base/log.h"
#include "hal/base/number.h"
#include "hal/base/text_file.h"

#define NUMBERS_MAX 16 /* of the largest matrix */
#define DEPTH_MAX 8    /* of lists and mappings in each other; aliases may make them endless */

struct foreign {
	const char *path;
	struct fault *fault;
	yaml_document_t document;
	yaml_node_t *lens; /* the mapping whose keys are the lens's */
};

/* A key with its value, as the file has them; line 0: it is not there. */
struct entry {
	const char *key;
	int line;
	yaml_node_t *value;
};

/* A matrix, or a list as a matrix of one row. */
struct matrix {
	struct entry at;
	int rows, columns, count;
	double data[NUMBERS_MAX];
};

/* What the keys are called; case and underscores do not matter. NULL ends each list. */
static const char *const matrix_words[] = {"cameramatrix", "k", NULL};
static const char *const distortion_words[] = {
	"distortioncoefficients", "distortioncoeffs", "distcoeffs", "distcoeff", "d", NULL};
static const char *const intrinsics_words[] = {"intrinsics", NULL};
static const char *const size_words[] = {"resolution", "imagesize", NULL};
static const char *const width_words[] = {"imagewidth", "width", NULL};
static const char *const height_words[] = {"imageheight", "height", NULL};
static const char *const fisheye_words[] = {"fisheyemodel", NULL};
static const char *const distortion_model_words[] = {"distortionmodel", NULL};
static const char *const camera_model_words[] = {"cameramodel", NULL};
static const char *const xi_words[] = {"xi", NULL};

/* ---- keys and values ---- */

static bool is_word(const char *key, const char *word)
{
	for (;;) {
		key += strspn(key, "_");
		if (!*key || !*word)
			return !*key && !*word;
		if (tolower((unsigned char)*key++) != *word++)
			return false;
	}
}

static bool is_one_of(const char *text, const char *const *words)
{
	while (*words && !is_word(text, *words))
		words++;
	return *words;
}

static const char *text_of(const yaml_node_t *node)
{
	return node && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : "";
}

static int entry_fault(const struct foreign *f, const struct entry *e, const char *expected)
{
	return fault_say(f->fault, -EINVAL, "%s:%d: %s: expected %s", f->path, e->line, e->key,
			 expected);
}

/* Finds a key of a mapping. -EINVAL: it is there twice. */
static int find_entry(struct foreign *f, const yaml_node_t *map, const char *const *words,
		      struct entry *found)
{
	*found = (struct entry){.key = ""};
	if (!map || map->type != YAML_MAPPING_NODE)
		return 0;
	for (yaml_node_pair_t *p = map->data.mapping.pairs.start; p < map->data.mapping.pairs.top;
	     p++) {
		const yaml_node_t *key = yaml_document_get_node(&f->document, p->key);

		if (!is_one_of(text_of(key), words))
			continue;
		if (found->line) {
			found->line = (int)key->start_mark.line + 1;
			return entry_fault(f, found, "to be there once");
		}
		*found = (struct entry){text_of(key), (int)key->start_mark.line + 1,
					yaml_document_get_node(&f->document, p->value)};
	}
	return 0;
}

static int read_whole(const struct foreign *f, const struct entry *e, const yaml_node_t *node,
		      int least, int most, int *value)
{
	const char *text = text_of(node);
	char *end, expected[64];
	long n;

	errno = 0;
	n = strtol(text, &end, 10);
	if (!errno && end != text && !*end && n >= least && n <= most) {
		*value = (int)n;
		return 0;
	}
	snprintf(expected, sizeof(expected), "a whole number from %d to %d", least, most);
	return entry_fault(f, e, expected);
}

/* Reads a whole number where there is one. */
static int take_whole(struct foreign *f, const char *const *words, int least, int most, int *value)
{
	struct entry e;
	int err = find_entry(f, f->lens, words, &e);

	return err || !e.line ? err : read_whole(f, &e, e.value, least, most, value);
}

/* Appends a number, or those of a list, of lists too. */
static int add_numbers(struct foreign *f, struct matrix *m, const yaml_node_t *node, int depth)
{
	const struct entry at = {m->at.key, node ? (int)node->start_mark.line + 1 : m->at.line,
				 NULL};
	int err = 0;

	if (node && node->type == YAML_SEQUENCE_NODE && depth < DEPTH_MAX) {
		for (yaml_node_item_t *i = node->data.sequence.items.start;
		     !err && i < node->data.sequence.items.top; i++)
			err = add_numbers(f, m, yaml_document_get_node(&f->document, *i),
					  depth + 1);
		return err;
	}
	if (m->count == NUMBERS_MAX)
		return entry_fault(f, &at, "fewer numbers");
	if (number_of(text_of(node), &m->data[m->count++]))
		return entry_fault(f, &at, "finite numbers");
	return 0;
}

/* Reads a list, or rows, cols and data. at.line is 0 where there is none. */
static int take_numbers(struct foreign *f, const char *const *words, struct matrix *m)
{
	static const char *const rows[] = {"rows", NULL}, *const columns[] = {"cols", NULL},
				 *const data[] = {"data", NULL};
	struct entry part[3];
	int err;

	*m = (struct matrix){.count = 0};
	err = find_entry(f, f->lens, words, &m->at);
	if (err || !m->at.line)
		return err;
	if (m->at.value && m->at.value->type != YAML_MAPPING_NODE) {
		err = add_numbers(f, m, m->at.value, 0);
		m->rows = m->count == 9 ? 3 : 1;
		m->columns = m->count / m->rows;
		return err;
	}
	err = find_entry(f, m->at.value, rows, &part[0]);
	if (!err)
		err = find_entry(f, m->at.value, columns, &part[1]);
	if (!err)
		err = find_entry(f, m->at.value, data, &part[2]);
	if (!err && part[0].line)
		err = read_whole(f, &m->at, part[0].value, 1, NUMBERS_MAX, &m->rows);
	if (!err && part[1].line)
		err = read_whole(f, &m->at, part[1].value, 1, NUMBERS_MAX, &m->columns);
	if (!err && part[2].line)
		err = add_numbers(f, m, part[2].value, 0);
	if (err || (m->count && m->count == m->rows * m->columns))
		return err;
	return fault_say(
		f->fault, -EINVAL,
		"%s:%d: %s: has %d rows, %d columns and %d numbers, expected as many as rows times columns",
		f->path, m->at.line, m->at.key, m->rows, m->columns, m->count);
}

/* ---- the lens ---- */

/* The word for its distortion; line 0: none. */
static int find_model(struct foreign *f, struct entry *model)
{
	/* ROS's older files name the distortion by camera_model; Kalibr names the projection by
	 * it */
	int err = find_entry(f, f->lens, distortion_model_words, model);

	return err || model->line ? err : find_entry(f, f->lens, camera_model_words, model);
}

static int take_model(struct foreign *f, struct lens *lens, bool *told)
{
	static const char *const fisheyes[] = {"equidistant", "fisheye", NULL};
	static const char *const pinholes[] = {
		"plumbbob", "rationalpolynomial", "radtan", "none", "pinhole", "", NULL};
	struct entry model;
	int whole = -1, err = take_whole(f, fisheye_words, 0, 1, &whole);

	if (!err)
		err = find_model(f, &model);
	if (err)
		return err;
	lens->fisheye = whole >= 0 ? whole == 1 : lens->fisheye;
	*told = whole >= 0 || model.line;
	if (!model.line)
		return 0;
	lens->fisheye = is_one_of(text_of(model.value), fisheyes);
	if (lens->fisheye || is_one_of(text_of(model.value), pinholes))
		return 0;
	return fault_say(
		f->fault, -EINVAL,
		"%s:%d: %s: %s, expected plumb_bob, radtan, rational_polynomial, equidistant or fisheye",
		f->path, model.line, model.key, text_of(model.value));
}

/* Refuses a message of a picture that is a part, or smaller. */
static int check_part(struct foreign *f)
{
	static const char *const names[][2] = {
		{"binningx", NULL}, {"binningy", NULL}, {"xoffset", NULL}, {"yoffset", NULL}};
	static const char *const roi_words[] = {"roi", NULL};
	struct entry roi, e;
	int err = find_entry(f, f->lens, roi_words, &roi);

	for (int k = 0; !err && k < 4; k++) {
		err = find_entry(f, k < 2 ? f->lens : roi.value, names[k], &e);
		if (!err && atoi(text_of(e.value)) > (k < 2))
			err = fault_say(
				f->fault, -EINVAL,
				"%s:%d: the picture is binned or cut out (%s), but K is of the whole one: expected a message of the whole picture",
				f->path, e.line, e.key);
	}
	return err;
}

static int take_matrix(struct foreign *f, struct lens *lens)
{
	struct matrix m;
	const double *k = m.data;
	struct entry xi;
	int err = take_numbers(f, matrix_words, &m);

	if (!err)
		err = find_entry(f, f->lens, xi_words, &xi);
	if (err)
		return err;
	if (xi.line)
		return entry_fault(f, &xi,
				   "a pinhole camera or a fisheye, not an omnidirectional camera");
	if (m.rows != 3 || m.columns != 3 || !(k[0] > 0) || !(k[4] > 0) || k[3] != 0 || k[6] != 0 ||
	    k[7] != 0 || k[8] != 1)
		return entry_fault(f, &m.at, "fx 0 cx, 0 fy cy, 0 0 1 with fx and fy above 0");
	if (k[1] != 0)
		return fault_say(
			f->fault, -EINVAL,
			"%s:%d: %s: a skew of %g, expected 0: rows and columns of pixels are at right angles here",
			f->path, m.at.line, m.at.key, k[1]);
	lens->focal_px[0] = k[0];
	lens->focal_px[1] = k[4];
	lens->centre_px[0] = k[2] + 0.5;
	lens->centre_px[1] = k[5] + 0.5;
	return 0;
}

/* Reads Kalibr's [fu, fv, pu, pv]. */
static int take_intrinsics(struct foreign *f, struct lens *lens)
{
	struct matrix m;
	struct entry model;
	int err = take_numbers(f, intrinsics_words, &m);

	if (!err)
		err = find_entry(f, f->lens, camera_model_words, &model);
	if (err || !m.at.line)
		return err;
	if (strcmp(text_of(model.value), "pinhole") != 0)
		return fault_say(f->fault, -EINVAL, "%s:%d: camera_model: %s, expected pinhole",
				 f->path, model.line ? model.line : m.at.line,
				 model.line ? text_of(model.value) : "none");
	if (m.count != 4 || !(m.data[0] > 0) || !(m.data[1] > 0))
		return entry_fault(f, &m.at, "[fu, fv, pu, pv] with fu and fv above 0");
	for (int i = 0; i < 2; i++) {
		lens->focal_px[i] = m.data[i];
		lens->centre_px[i] = m.data[2 + i] + 0.5;
	}
	return 0;
}

/* Checks four coefficients without a word of their model: K and D are what Python programs save
 * of either camera, while OpenCV's calibration program, with its longer names, says so of a
 * fisheye. */
static int check_four(const struct foreign *f, const struct lens *lens, const struct matrix *m,
		      bool told)
{
	static const char what[] =
		"4 of them are k1 k2 p1 p2 of a pinhole camera or k1 to k4 of a fisheye, and nothing says which";

	if (m->count != 4 || lens->fisheye || told)
		return 0;
	if (strlen(m->at.key) == 1)
		return fault_say(
			f->fault, -EINVAL,
			"%s:%d: %s: %s: expected --fisheye, or a line distortion_model: plumb_bob",
			f->path, m->at.line, m->at.key, what);
	log_warning("%s:%d: %s: %s: a pinhole camera is taken, --fisheye takes the other", f->path,
		    m->at.line, m->at.key, what);
	return 0;
}

static int take_distortion(struct foreign *f, struct lens *lens, bool told)
{
	const int most = lens->fisheye ? FISHEYE_TERMS : LENS_TERMS;
	struct entry model;
	struct matrix m;
	int err = take_numbers(f, distortion_words, &m);

	if (!err)
		err = find_model(f, &model);
	if (err)
		return err;
	if (!m.at.line) {
		if (!strcmp(text_of(model.value), "none"))
			return 0;
		return fault_say(f->fault, -EINVAL, "%s: has no distortion_coefficients", f->path);
	}
	if ((m.count && m.rows != 1 && m.columns != 1) ||
	    (lens->fisheye && m.count && m.count != FISHEYE_TERMS))
		return fault_say(f->fault, -EINVAL,
				 "%s:%d: %s: %d x %d of them, expected one row%s", f->path,
				 m.at.line, m.at.key, m.rows, m.columns,
				 lens->fisheye ? " of 4" : "");
	err = check_four(f, lens, &m, told);
	if (err)
		return err;
	for (int k = 0; k < m.count; k++) {
		if (k < most)
			lens->term[k] = m.data[k];
		else if (m.data[k] != 0)
			return fault_say(
				f->fault, -EINVAL,
				"%s:%d: %s: number %d is %g, expected 0: neither thin prisms nor tilted sensors are known here",
				f->path, m.at.line, m.at.key, k + 1, m.data[k]);
	}
	return 0;
}

static int take_size(struct foreign *f, struct lens *lens)
{
	struct matrix m;
	int err = take_numbers(f, size_words, &m);

	if (!err && m.count == 2 && fmin(m.data[0], m.data[1]) >= 1 &&
	    fmax(m.data[0], m.data[1]) <= TSAI_SIDE_MAX) {
		lens->width = (int)m.data[0];
		lens->height = (int)m.data[1];
	}
	if (!err)
		err = take_whole(f, width_words, 1, TSAI_SIDE_MAX, &lens->width);
	if (!err)
		err = take_whole(f, height_words, 1, TSAI_SIDE_MAX, &lens->height);
	if (err || (lens->width > 0 && lens->height > 0))
		return err;
	return fault_say(f->fault, -EINVAL,
			 "%s: has no image_width and image_height, expected them here or by --size",
			 f->path);
}

/* ---- the file ---- */

/* Loads the first message with anything in it. */
static int load_document(struct foreign *f, const char *text, size_t bytes)
{
	yaml_parser_t parser;
	int err = 0;

	if (!yaml_parser_initialize(&parser))
		return fault_say(f->fault, -ENOMEM, "%s: out of memory", f->path);
	yaml_parser_set_input_string(&parser, (const unsigned char *)text, bytes);
	if (!yaml_parser_load(&parser, &f->document))
		err = fault_say(f->fault, parser.error == YAML_MEMORY_ERROR ? -ENOMEM : -EINVAL,
				"%s:%d: %s, expected YAML, as OpenCV, ROS and Kalibr write lenses",
				f->path, (int)parser.problem_mark.line + 1,
				parser.problem ? parser.problem : "no text");
	yaml_parser_delete(&parser);
	return err;
}

/* Reads the file's text without OpenCV's "%YAML:1.0", which is no YAML. */
static int read_document(struct foreign *f)
{
	struct text_file file;
	char *text = NULL;
	size_t bytes;
	FILE *copy;
	int err = text_file_open(&file, f->path, f->fault);

	if (err)
		return err;
	copy = open_memstream(&text, &bytes);
	while (copy && (err = text_file_next(&file, f->fault)) > 0)
		fprintf(copy, "%s\n", *file.line == '%' ? "" : file.line);
	text_file_close(&file);
	if (!copy || fclose(copy))
		err = fault_say(f->fault, -ENOMEM, "%s: out of memory", f->path);
	if (!err)
		err = load_document(f, text, bytes);
	free(text);
	return err;
}

/* Whether a mapping has what no lens is without; a fault of a key that is there twice is said
 * when it is read. */
static bool is_lens(struct foreign *f, const yaml_node_t *map)
{
	struct entry matrix = {.line = 0}, intrinsics = {.line = 0};

	(void)find_entry(f, map, matrix_words, &matrix);
	(void)find_entry(f, map, intrinsics_words, &intrinsics);
	return matrix.line || intrinsics.line;
}

/* Finds the lens: the file's own mapping, or that of the wanted name, or the only one, below it. */
static int find_lens(struct foreign *f, const char *wanted)
{
	yaml_node_t *root = yaml_document_get_root_node(&f->document);
	const char *first = "";

	if (!root || root->type != YAML_MAPPING_NODE)
		root = NULL;
	if (is_lens(f, root)) {
		f->lens = root;
		return 0;
	}
	for (yaml_node_pair_t *p = root ? root->data.mapping.pairs.start : NULL;
	     root && p < root->data.mapping.pairs.top; p++) {
		const yaml_node_t *key = yaml_document_get_node(&f->document, p->key);
		yaml_node_t *below = yaml_document_get_node(&f->document, p->value);

		if (!is_lens(f, below) || (wanted && strcmp(text_of(key), wanted) != 0))
			continue;
		if (f->lens)
			return fault_say(
				f->fault, -EINVAL,
				"%s:%d: holds several cameras, %s and %s: expected one of them by --camera",
				f->path, (int)key->start_mark.line + 1, first, text_of(key));
		f->lens = below;
		first = text_of(key);
	}
	if (f->lens)
		return 0;
	return wanted ? fault_say(f->fault, -EINVAL, "%s: has no camera %s", f->path, wanted)
		      : fault_say(
				f->fault, -EINVAL,
				"%s: has no camera_matrix of OpenCV, K of ROS or intrinsics of Kalibr",
				f->path);
}

int lens_read_foreign(struct lens *lens, const char *path, const char *camera, struct fault *fault)
{
	struct foreign f = {.path = path, .fault = fault};
	bool told = false;
	int err = read_document(&f);

	if (err)
		return err;
	err = find_lens(&f, camera);
	if (!err)
		err = check_part(&f);
	if (!err)
		err = take_size(&f, lens);
	if (!err)
		err = take_model(&f, lens, &told);
	if (!err)
		err = take_intrinsics(&f, lens);
	if (!err && !(lens->focal_px[0] > 0))
		err = take_matrix(&f, lens);
	if (!err)
		err = take_distortion(&f, lens, told);
	yaml_document_delete(&f.document);
	return err;
}
