/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "bake/mesh/formats/formats.h"
#include "bake/mesh/formats/soup.h"
#include "bake/mesh/formats/text.h"
#include "bake/mesh/formats/textures.h"
#include "bake/mesh/left_out.h"
#include "bake/mesh/plain_file.h"
#include "hal/colour/transfer.h"

#define ELEMENTS_MAX 32
#define PROPERTIES_MAX 512
#define TEXTURES_MAX 256

struct ply_type {
	const char *name, *other_name;
	int bytes;
	bool whole;
	double most; /* what counts as 1 of a colour */
};

static const struct ply_type types[] = {
	{"char", "int8", 1, true, 127},	    {"uchar", "uint8", 1, true, 255},
	{"short", "int16", 2, true, 32767}, {"ushort", "uint16", 2, true, 65535},
	{"int", "int32", 4, true, INT_MAX}, {"uint", "uint32", 4, true, UINT_MAX},
	{"float", "float32", 4, false, 1},  {"double", "float64", 8, false, 1},
};

enum ply_role {
	ROLE_NONE,
	ROLE_X,
	ROLE_Y,
	ROLE_Z,
	ROLE_NORMAL_X,
	ROLE_NORMAL_Y,
	ROLE_NORMAL_Z,
	ROLE_U,
	ROLE_V,
	ROLE_RED,
	ROLE_GREEN,
	ROLE_BLUE,
	ROLE_ALPHA,
	ROLE_TEXTURE, /* its number */
	ROLE_CORNERS, /* lists */
	ROLE_UVS,
	ROLE_COUNT
};

/* What properties are called, by various programs. */
static const struct ply_word {
	const char *name;
	enum ply_role role;
} words[] = {
	{"x", ROLE_X},
	{"y", ROLE_Y},
	{"z", ROLE_Z},
	{"nx", ROLE_NORMAL_X},
	{"ny", ROLE_NORMAL_Y},
	{"nz", ROLE_NORMAL_Z},
	{"u", ROLE_U},
	{"v", ROLE_V},
	{"s", ROLE_U},
	{"t", ROLE_V},
	{"texture_u", ROLE_U},
	{"texture_v", ROLE_V},
	{"red", ROLE_RED},
	{"green", ROLE_GREEN},
	{"blue", ROLE_BLUE},
	{"alpha", ROLE_ALPHA},
	{"r", ROLE_RED},
	{"g", ROLE_GREEN},
	{"b", ROLE_BLUE},
	{"a", ROLE_ALPHA},
	{"diffuse_red", ROLE_RED},
	{"diffuse_green", ROLE_GREEN},
	{"diffuse_blue", ROLE_BLUE},
	{"texnumber", ROLE_TEXTURE},
	{"vertex_indices", ROLE_CORNERS},
	{"vertex_index", ROLE_CORNERS},
	{"texcoord", ROLE_UVS},
};

struct ply_property {
	const struct ply_type *type, *count; /* count NULL: no list */
	enum ply_role role;
};

struct ply_element {
	struct text_span name;
	int line;
	size_t count;
	int properties;
	struct ply_property *property;
	unsigned roles; /* bits */
};

struct ply {
	const char *path;
	struct text_lines lines;
	struct text_span row; /* of text: what is left of it */
	bool ascii, big_endian;
	int elements, properties;
	struct ply_element element[ELEMENTS_MAX];
	struct ply_property property[PROPERTIES_MAX];

	/* values of one row; number and list of a role */
	double number[ROLE_COUNT];
	double *list[ROLE_COUNT];
	size_t listed[ROLE_COUNT], list_room[ROLE_COUNT];

	bool with_materials, uvs, colours, see_through;
	unsigned vertex_has;
	struct soup_corner *vertex;
	size_t vertices, vertex_room;
	struct soup_corner *corner; /* of a face */
	size_t corner_room;
	struct texture_name texture[TEXTURES_MAX];
	int texture_count;
	struct soup soup;
	struct textures textures;
	struct left_out out;
};

static int ply_lack(const struct ply *ply, struct fault *fault)
{
	return fault_say(fault, -ENOMEM, "%s: out of memory", ply->path);
}

/* ---- the header ---- */

static const struct ply_type *ply_type_of(const struct ply *ply, struct text_span *line,
					  struct fault *fault)
{
	const struct text_span word = text_word(line);

	for (size_t k = 0; k < sizeof(types) / sizeof(*types); k++)
		if (text_is(word, types[k].name) || text_is(word, types[k].other_name))
			return &types[k];
	fault_say(
		fault, -EBADMSG,
		"%s:%d: property of type \"%.*s\", expected char, uchar, short, ushort, int, uint, "
		"float or double",
		ply->path, ply->lines.line, text_shown(word), word.at);
	return NULL;
}

static enum ply_role role_of(struct text_span name, bool list)
{
	for (size_t k = 0; k < sizeof(words) / sizeof(*words); k++)
		if (text_is(name, words[k].name) && (words[k].role >= ROLE_CORNERS) == list)
			return words[k].role;
	return ROLE_NONE;
}

static int header_property(struct ply *ply, struct text_span line, struct fault *fault)
{
	struct ply_property *property = &ply->property[ply->properties];
	struct ply_element *element;
	struct text_span list = line;

	if (!ply->elements)
		return fault_say(fault, -EBADMSG,
				 "%s:%d: a property by itself, expected an element first",
				 ply->path, ply->lines.line);
	if (ply->properties == PROPERTIES_MAX)
		return fault_say(fault, -E2BIG, "%s:%d: expected at most %d properties", ply->path,
				 ply->lines.line, PROPERTIES_MAX);
	element = &ply->element[ply->elements - 1];
	*property = (struct ply_property){.type = NULL};
	if (text_is(text_word(&list), "list")) {
		line = list;
		property->count = ply_type_of(ply, &line, fault);
		if (!property->count)
			return -EBADMSG;
		if (!property->count->whole)
			return fault_say(fault, -EBADMSG,
					 "%s:%d: a list counted in %s, expected whole numbers",
					 ply->path, ply->lines.line, property->count->name);
	}
	property->type = ply_type_of(ply, &line, fault);
	if (!property->type)
		return -EBADMSG;
	property->role = role_of(text_word(&line), property->count);
	ply->properties++;
	element->properties++;
	element->roles |= 1u << property->role;
	return 0;
}

static int header_element(struct ply *ply, struct text_span line, struct fault *fault)
{
	const struct text_span name = text_word(&line), word = text_word(&line);
	struct text_span digits = word;
	int64_t count;

	if (!text_whole(&digits, &count) || !text_empty(digits) || count < 0 || count > INT_MAX)
		return fault_say(fault, -EBADMSG,
				 "%s:%d: element %.*s \"%.*s\", expected a number 0..%d", ply->path,
				 ply->lines.line, text_shown(name), name.at, text_shown(word),
				 word.at, INT_MAX);
	if (ply->elements == ELEMENTS_MAX)
		return fault_say(fault, -E2BIG, "%s:%d: expected at most %d elements", ply->path,
				 ply->lines.line, ELEMENTS_MAX);
	ply->element[ply->elements++] = (struct ply_element){
		.name = name,
		.line = ply->lines.line,
		.count = (size_t)count,
		.property = &ply->property[ply->properties],
	};
	return 0;
}

/* MeshLab names textures in comments. */
static int header_comment(struct ply *ply, struct text_span line, struct fault *fault)
{
	const struct text_span word = text_word(&line), name = text_name(line);
	struct texture_name *texture = &ply->texture[ply->texture_count];

	if (!text_is_any_case(word, "TextureFile") || text_empty(name) ||
	    ply->texture_count == TEXTURES_MAX)
		return 0;
	*texture = (struct texture_name){ply->path, ply->lines.line, text_copy(name)};
	ply->texture_count++;
	return texture->name ? 0 : ply_lack(ply, fault);
}

static bool header_format(struct ply *ply, struct text_span line)
{
	const struct text_span kind = text_word(&line);

	ply->ascii = text_is(kind, "ascii");
	ply->big_endian = text_is(kind, "binary_big_endian");
	return ply->ascii || ply->big_endian || text_is(kind, "binary_little_endian");
}

/* Reads up to end_header. Skips words that it does not know. */
static int ply_read_header(struct ply *ply, struct fault *fault)
{
	const char *first = ply->lines.rest.at;
	const bool macintosh = ply->lines.rest.end - first > 4 && first[3] == '\r' &&
			       first[4] != '\n';
	struct text_span line;
	bool format = false;
	int err = 0;

	while (!err && text_next(&ply->lines, &line)) {
		const char *const line_end = line.end;
		const struct text_span word = text_word(&line);

		if (text_is(word, "format") && !header_format(ply, line))
			break;
		format |= text_is(word, "format");
		if (text_is(word, "end_header") && format) {
			/* data may begin with a byte of "\n" */
			if (macintosh && line_end < ply->lines.rest.end)
				ply->lines.rest.at = line_end + 1;
			return 0;
		}
		if (line_end == ply->lines.rest.end)
			break; /* cut short */
		if (text_is(word, "property"))
			err = header_property(ply, line, fault);
		else if (text_is(word, "element"))
			err = header_element(ply, line, fault);
		else if (text_is(word, "comment"))
			err = header_comment(ply, line, fault);
	}
	if (err)
		return err;
	return format ? fault_say(fault, -EBADMSG,
				  "%s: no line end_header, expected one at the end of the header: "
				  "damaged or cut short",
				  ply->path)
		      : fault_say(fault, -EBADMSG,
				  "%s:%d: expected format ascii, binary_little_endian or "
				  "binary_big_endian in the header",
				  ply->path, ply->lines.line);
}

/* ---- rows ---- */

/* Says where a row is, and what is wrong there. */
static int ply_refuse(const struct ply *ply, const struct ply_element *element, size_t row,
		      const char *what, const char *expected, struct fault *fault)
{
	char place[16] = "";

	if (ply->ascii)
		snprintf(place, sizeof(place), ":%d", ply->lines.line);
	return fault_say(fault, -EBADMSG, "%s%s: %.*s %zu %s, expected %s: damaged or cut short",
			 ply->path, place, text_shown(element->name), element->name.at, row + 1,
			 what, expected);
}

static int ply_cut(const struct ply *ply, const struct ply_element *element, size_t row,
		   struct fault *fault)
{
	return fault_say(fault, -EBADMSG,
			 "%s: it ends in %.*s %zu, expected %zu of them: damaged or cut short",
			 ply->path, text_shown(element->name), element->name.at, row + 1,
			 element->count);
}

static int refuse_word(const struct ply *ply, const struct ply_element *element, size_t row,
		       struct text_span word, const char *expected, struct fault *fault)
{
	char what[128] = "ends here";

	if (!text_empty(word))
		snprintf(what, sizeof(what), "has \"%.*s\"", text_shown(word), word.at);
	return ply_refuse(ply, element, row, what, expected, fault);
}

static double binary_value(const char *at, const struct ply_type *type, bool big_endian)
{
	const int n = type->bytes;
	uint64_t bits = 0;
	float single;
	double wide;

	for (int k = 0; k < n; k++)
		bits |= (uint64_t)(uint8_t)at[k] << 8 * (big_endian ? n - 1 - k : k);
	if (!type->whole && n == 4) {
		const uint32_t word = (uint32_t)bits;

		memcpy(&single, &word, sizeof(single));
		return (double)single;
	}
	if (!type->whole) {
		memcpy(&wide, &bits, sizeof(wide));
		return wide;
	}
	/* names of signed types do not begin with u */
	if (type->name[0] != 'u' && bits >> (8 * n - 1))
		return (double)bits - (double)(1ull << 8 * n);
	return (double)bits;
}

/* Takes a value; expected says in a fault what it is. */
static int ply_take(struct ply *ply, const struct ply_type *type, double *value,
		    const struct ply_element *element, size_t row, const char *expected,
		    struct fault *fault)
{
	struct text_span *rest = &ply->lines.rest, word;

	if (ply->ascii) {
		word = text_word(&ply->row);
		return text_number(word, value)
			       ? 0
			       : refuse_word(ply, element, row, word, expected, fault);
	}
	if (rest->end - rest->at < type->bytes)
		return ply_cut(ply, element, row, fault);
	*value = binary_value(rest->at, type, ply->big_endian);
	rest->at += type->bytes;
	return 0;
}

static int ply_take_list(struct ply *ply, const struct ply_property *p,
			 const struct ply_element *element, size_t row, struct fault *fault)
{
	const enum ply_role role = p->role;
	const struct text_span before = ply->row;
	double count, value;
	int err = ply_take(ply, p->count, &count, element, row, "how many numbers follow", fault);

	if (err)
		return err;
	if (!(count >= (role == ROLE_CORNERS)) || count > INT_MAX || count != floor(count)) {
		struct text_span rest = before;

		if (ply->ascii)
			return refuse_word(ply, element, row, text_word(&rest),
					   "how many numbers follow", fault);
		return ply_refuse(ply, element, row, "has a list without numbers", "some", fault);
	}
	ply->listed[role] = 0;
	for (int64_t k = 0; k < (int64_t)count && !err; k++) {
		err = ply_take(ply, p->type, &value, element, row, "a number", fault);
		if (err || role == ROLE_NONE)
			continue;
		if (ply->listed[role] == ply->list_room[role]) {
			const size_t room = 2 * ply->list_room[role] + 16;
			double *grown = realloc(ply->list[role], room * sizeof(*grown));

			if (!grown)
				return ply_lack(ply, fault);
			ply->list[role] = grown;
			ply->list_room[role] = room;
		}
		ply->list[role][ply->listed[role]++] = value;
	}
	return err;
}

/* Reads a row of any element into number and list. Empty lines between rows do not count. */
static int ply_read_row(struct ply *ply, const struct ply_element *element, size_t row,
			struct fault *fault)
{
	int err = 0;

	if (ply->ascii) {
		do {
			if (!text_next(&ply->lines, &ply->row))
				return ply_cut(ply, element, row, fault);
		} while (text_empty(ply->row));
	}
	for (int k = 0; k < element->properties && !err; k++) {
		const struct ply_property *p = &element->property[k];
		double *value = &ply->number[p->role];

		if (p->count) {
			err = ply_take_list(ply, p, element, row, fault);
			continue;
		}
		err = ply_take(ply, p->type, value, element, row, "a number", fault);
		if (p->role >= ROLE_RED && p->role <= ROLE_ALPHA)
			*value /= p->type->most;
	}
	return err;
}

/* ---- vertices ---- */

static bool has_roles(const struct ply_element *element, enum ply_role first, int count)
{
	for (int k = 0; k < count; k++)
		if (!(element->roles >> ((int)first + k) & 1))
			return false;
	return true;
}

/* Code values are sRGB. */
static void ply_colour(struct ply *ply, const struct ply_element *element, float colour[4])
{
	for (int c = 0; c < 3; c++) {
		const double code = ply->number[ROLE_RED + c];

		colour[c] = (float)transfer_decode(TRANSFER_SRGB, code > 0 ? fmin(code, 1) : 0);
	}
	colour[3] = 1;
	if (element->roles >> ROLE_ALPHA & 1)
		ply->see_through |= ply->number[ROLE_ALPHA] < 1;
}

static float finite_or_0(double value)
{
	return isfinite((float)value) ? (float)value : 0;
}

static int ply_add_vertex(struct ply *ply, const struct ply_element *element, size_t row,
			  struct fault *fault)
{
	const double *number = ply->number;
	struct soup_corner *grown, *corner;

	if (ply->vertices == ply->vertex_room) {
		const size_t room = 2 * ply->vertex_room + 1024;

		grown = realloc(ply->vertex, room * sizeof(*grown));
		if (!grown)
			return ply_lack(ply, fault);
		ply->vertex = grown;
		ply->vertex_room = room;
	}
	corner = &ply->vertex[ply->vertices++];
	*corner = (struct soup_corner){.colour = {1, 1, 1, 1}};
	for (int axis = 0; axis < 3; axis++) {
		corner->position[axis] = (float)number[ROLE_X + axis];
		if (!isfinite(corner->position[axis]))
			return fault_say(fault, -EDOM,
					 "%s: vertex %zu is not finite, expected numbers",
					 ply->path, row + 1);
		if (ply->vertex_has & SOUP_NORMALS)
			corner->normal[axis] = finite_or_0(number[ROLE_NORMAL_X + axis]);
	}
	if (ply->vertex_has & SOUP_UVS) {
		corner->uv[0] = finite_or_0(number[ROLE_U]);
		corner->uv[1] = finite_or_0(number[ROLE_V]);
	}
	if (ply->vertex_has & SOUP_COLOURS)
		ply_colour(ply, element, corner->colour);
	return 0;
}

static int ply_begin_vertices(struct ply *ply, const struct ply_element *element,
			      struct fault *fault)
{
	if (element->properties && !has_roles(element, ROLE_X, 3))
		return fault_say(fault, -EBADMSG,
				 "%s: its vertices have no x, y and z, expected these properties",
				 ply->path);
	if (has_roles(element, ROLE_NORMAL_X, 3))
		ply->vertex_has |= SOUP_NORMALS;
	if (has_roles(element, ROLE_U, 2))
		ply->vertex_has |= SOUP_UVS;
	if (has_roles(element, ROLE_RED, 3))
		ply->vertex_has |= SOUP_COLOURS;
	return 0;
}

/* ---- faces ---- */

static bool has_normal(const struct soup_corner *corner)
{
	return corner->normal[0] != 0 || corner->normal[1] != 0 || corner->normal[2] != 0;
}

/* Adds the corners of list[first .. first + count), which are in range. turned: in the order of a
 * strip's second triangle. */
static int ply_add_polygon(struct ply *ply, const struct ply_element *element, size_t first,
			   size_t count, bool turned, struct fault *fault)
{
	const double *list = ply->list[ROLE_CORNERS];
	const bool wedges = element->roles >> ROLE_UVS & 1 &&
			    ply->listed[ROLE_UVS] >= 2 * (first + count);
	unsigned has = ply->vertex_has | (wedges ? SOUP_UVS : 0);
	int texture = ply->texture_count ? 0 : -1;

	if (count > ply->corner_room) {
		struct soup_corner *grown = realloc(ply->corner, 2 * count * sizeof(*grown));

		if (!grown)
			return ply_lack(ply, fault);
		ply->corner = grown;
		ply->corner_room = 2 * count;
	}
	for (size_t k = 0; k < count; k++) {
		const size_t at = first + (turned && k < 2 ? 1 - k : k);
		struct soup_corner *corner = &ply->corner[k];

		*corner = ply->vertex[(size_t)list[at]];
		if (!has_normal(corner))
			has &= ~SOUP_NORMALS;
		if (wedges)
			for (int i = 0; i < 2; i++)
				corner->uv[i] =
					finite_or_0(ply->list[ROLE_UVS][2 * at + (size_t)i]);
		if (!(has & SOUP_COLOURS) && has_roles(element, ROLE_RED, 3))
			ply_colour(ply, element, corner->colour);
	}
	if (element->roles >> ROLE_TEXTURE & 1)
		texture = ply->number[ROLE_TEXTURE] >= 0 &&
					  ply->number[ROLE_TEXTURE] < ply->texture_count
				  ? (int)ply->number[ROLE_TEXTURE]
				  : -1;
	if (has_roles(element, ROLE_RED, 3))
		has |= SOUP_COLOURS;
	if (!(has & SOUP_UVS))
		texture = -1;
	if (!ply->with_materials || texture >= 0)
		has &= ~SOUP_COLOURS;
	ply->colours |= has & SOUP_COLOURS;
	return soup_add(&ply->soup, ply->corner, (int)count, ply->with_materials ? texture + 1 : 0,
			has, fault);
}

static int check_corner(const struct ply *ply, const struct ply_element *element, size_t row,
			double corner, struct fault *fault)
{
	char what[64], expected[64];

	if (corner >= 0 && corner < (double)ply->vertices && corner == floor(corner))
		return 0;
	snprintf(what, sizeof(what), "names vertex %.10g", corner);
	snprintf(expected, sizeof(expected), "less than %zu", ply->vertices);
	return ply_refuse(ply, element, row, what, expected, fault);
}

static int ply_add_face(struct ply *ply, const struct ply_element *element, size_t row,
			struct fault *fault)
{
	const size_t count = ply->listed[ROLE_CORNERS];
	struct text_span word = {NULL, NULL};
	int err = 0;

	for (size_t k = 0; k < count && !err; k++)
		err = check_corner(ply, element, row, ply->list[ROLE_CORNERS][k], fault);
	if (ply->ascii)
		word = text_word(&ply->row);
	if (!err && !text_empty(word)) {
		char what[128];

		snprintf(what, sizeof(what), "has \"%.*s\" after its vertices", text_shown(word),
			 word.at);
		err = ply_refuse(ply, element, row, what, "as many as it counts", fault);
	}
	return err ? err : ply_add_polygon(ply, element, 0, count, false, fault);
}

/* A strip: each corner makes a triangle with the two before it; -1 begins another strip. */
static int ply_add_strip(struct ply *ply, const struct ply_element *element, size_t row,
			 struct fault *fault)
{
	const double *list = ply->list[ROLE_CORNERS];
	size_t length = 0;
	int err = 0;

	for (size_t k = 0; k < ply->listed[ROLE_CORNERS] && !err; k++) {
		if (list[k] == -1) {
			length = 0;
			continue;
		}
		err = check_corner(ply, element, row, list[k], fault);
		length++;
		if (!err && length >= 3)
			err = ply_add_polygon(ply, element, k - 2, 3, length % 2 == 0, fault);
	}
	return err;
}

/* ---- the file ---- */

typedef int ply_add(struct ply *ply, const struct ply_element *element, size_t row,
		    struct fault *fault);

static int ply_skip(struct ply *ply, const struct ply_element *element, size_t row,
		    struct fault *fault)
{
	(void)ply, (void)element, (void)row, (void)fault;
	return 0;
}

static ply_add *adds_faces(const struct ply_element *element)
{
	if (!(element->roles >> ROLE_CORNERS & 1))
		return ply_skip;
	return text_is(element->name, "face")	     ? ply_add_face
	       : text_is(element->name, "tristrips") ? ply_add_strip
						     : ply_skip;
}

static int ply_read_element(struct ply *ply, const struct ply_element *element, ply_add *add,
			    struct fault *fault)
{
	int err = 0;

	if (element->count && !element->properties)
		return fault_say(fault, -EBADMSG,
				 "%s:%d: element %.*s has no property, expected at least one",
				 ply->path, element->line, text_shown(element->name),
				 element->name.at);
	for (size_t row = 0; row < element->count && !err; row++) {
		err = ply_read_row(ply, element, row, fault);
		if (!err)
			err = add(ply, element, row, fault);
	}
	return err;
}

/* Reads vertices first, wherever they are. Where faces stand before them, all is read once more. */
static int ply_read_rows(struct ply *ply, struct fault *fault)
{
	const struct text_lines begin = ply->lines;
	int vertices = 0, first, err = 0;
	bool again = false;

	while (vertices < ply->elements && !text_is(ply->element[vertices].name, "vertex"))
		again |= adds_faces(&ply->element[vertices++]) != ply_skip;
	for (int k = 0; k < vertices && !err; k++)
		err = ply_read_element(ply, &ply->element[k], ply_skip, fault);
	if (!err && vertices < ply->elements)
		err = ply_begin_vertices(ply, &ply->element[vertices], fault);
	if (!err && vertices < ply->elements)
		err = ply_read_element(ply, &ply->element[vertices], ply_add_vertex, fault);
	first = again ? 0 : vertices + 1;
	if (again)
		ply->lines = begin;
	for (int k = first; k < ply->elements && !err; k++) {
		const struct ply_element *e = &ply->element[k];

		err = ply_read_element(ply, e, adds_faces(e), fault);
		if (e->count && text_is(e->name, "edge"))
			left_out_add(&ply->out, "edges", "mesh");
	}
	return err;
}

/* Material 0 has no texture, k + 1 has texture k. */
static int ply_add_materials(struct ply *ply, struct fault *fault)
{
	struct mesh *mesh = ply->textures.mesh;
	int err = 0;

	mesh->materials = calloc((size_t)ply->texture_count + 1, sizeof(*mesh->materials));
	if (!mesh->materials)
		return ply_lack(ply, fault);
	for (int k = -1; k < ply->texture_count && !err; k++) {
		struct material *m = &mesh->materials[mesh->material_count++];
		bool used = false;

		*m = (struct material){.ior = 1.5f, .alpha = 1, .colour = {{0.8f, 0.8f, 0.8f}}};
		if (k >= 0 || ply->colours)
			m->colour = rgb_make(1, 1, 1);
		for (int part = 0; part < mesh->part_count; part++)
			used |= mesh->parts[part].material == k + 1;
		if (k >= 0 && used)
			err = textures_colour(&ply->textures, &ply->texture[k], NULL,
					      TEXTURE_REPEAT, &m->texture, fault);
	}
	return err;
}

static int ply_read_file(struct ply *ply, double crease_deg, struct fault *fault)
{
	int err = ply_read_header(ply, fault);

	if (!err)
		err = ply_read_rows(ply, fault);
	if (!err)
		err = soup_finish(&ply->soup, ply->textures.mesh, crease_deg, fault);
	if (!err && ply->with_materials)
		err = ply_add_materials(ply, fault);
	if (!err && ply->see_through && ply->with_materials)
		left_out_add(&ply->out, "alpha of vertices", "mesh");
	return err;
}

static void ply_free(struct ply *ply)
{
	for (int k = 0; k < ROLE_COUNT; k++)
		free(ply->list[k]);
	for (int k = 0; k < ply->texture_count; k++)
		free((char *)ply->texture[k].name);
	free(ply->vertex);
	free(ply->corner);
	soup_free(&ply->soup);
	textures_free(&ply->textures);
	free(ply);
}

int ply_read(struct mesh *mesh, const char *path, double crease_deg, bool materials,
	     struct fault *fault)
{
	struct plain_map file;
	struct ply *ply;
	int err = plain_file_map(&file, path, PLAIN_FILE_MAX, fault);

	if (err)
		return err;
	ply = calloc(1, sizeof(*ply));
	if (!ply) {
		plain_file_unmap(&file);
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	}
	ply->path = path;
	ply->with_materials = materials;
	ply->textures = (struct textures){.mesh = mesh, .mesh_path = path};
	soup_begin(&ply->soup, path);
	text_begin(&ply->lines, file.at, file.bytes);
	err = ply_read_file(ply, crease_deg, fault);
	plain_file_unmap(&file);
	if (!err)
		left_out_say(&ply->out, path);
	ply_free(ply);
	return err;
}
