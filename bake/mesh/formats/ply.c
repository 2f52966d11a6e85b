/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/mesh/formats/formats.h"
#include "bake/mesh/formats/soup.h"

#define ELEMENTS_MAX 32
#define PROPERTIES_MAX 512
#define TEXTURES_MAX 256
#define LENGTH(array) (sizeof(array) / sizeof(*(array)))

/* Kinds of numbers by their place here. */
static const char *const types[] = {"char uchar short ushort int uint float double",
				    "int8 uint8 int16 uint16 int32 uint32 float32 float64"};

static const int bytes_of[] = {1, 1, 2, 2, 4, 4, 4, 8};

#define FIRST_FLOAT 6 /* of types; of those before it each second one has a sign */

enum ply_role {
	ROLE_NONE,
	ROLE_X, /* and Y and Z */
	ROLE_NORMAL = ROLE_X + 3,
	ROLE_UV = ROLE_NORMAL + 3,
	ROLE_COLOUR = ROLE_UV + 2, /* red, green, blue */
	ROLE_ALPHA = ROLE_COLOUR + 3,
	ROLE_TEXTURE, /* its number */
	ROLE_CORNERS, /* lists */
	ROLE_UVS,
	ROLE_COUNT
};

/* What properties are called, in the order of their roles, by various programs. */
static const char *const names[] = {
	"x y z nx ny nz u v red green blue alpha texnumber vertex_indices texcoord",
	"- - - - - - s t r g b a - vertex_index",
	"- - - - - - texture_u texture_v diffuse_red diffuse_green diffuse_blue",
};

struct ply_property {
	int type, count; /* count -1: one number */
	int role;
};

struct ply_element {
	struct text_span name;
	int line;
	size_t count;
	int properties;
	const struct ply_property *property;
	unsigned roles; /* bits */
};

struct ply {
	struct soup soup;
	bool ascii, big_endian, colours;
	int type[ROLE_COUNT]; /* of each role's numbers */
	double least_alpha, most_alpha;
	int elements, properties;
	struct ply_element element[ELEMENTS_MAX];
	struct ply_property property[PROPERTIES_MAX];

	/* the row that is being read: what is left of its text; the numbers of each role */
	const struct ply_element *of;
	size_t row;
	struct text_span rest;
	double *value[ROLE_COUNT];
	size_t values[ROLE_COUNT], room[ROLE_COUNT];

	unsigned vertex_has;
	struct soup_corner *vertex, *corner; /* of the file; of a polygon */
	size_t vertices, vertex_room, corner_room;
	struct texture_name texture[TEXTURES_MAX];
	int texture_count;
};

static bool has_roles(const struct ply_element *element, int first, int count)
{
	return !(~element->roles >> first & ((1u << count) - 1));
}

/* ---- the header ---- */

static int header_refuse(const struct ply *ply, int line, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
static int header_refuse(const struct ply *ply, int line, const char *format, ...)
{
	char text[256];
	va_list list;

	va_start(list, format);
	vsnprintf(text, sizeof(text), format, list);
	va_end(list);
	return fault_say(ply->soup.fault, -EBADMSG, "%s:%d: %s", ply->soup.path, line, text);
}

static int type_of(struct text_span word)
{
	const int place = text_place(word, types[0]);

	return place >= 0 ? place : text_place(word, types[1]);
}

static int role_of(struct text_span name, bool list)
{
	for (size_t k = 0; k < LENGTH(names); k++) {
		const int role = ROLE_X + text_place(name, names[k]);

		if (role >= ROLE_X && (role >= ROLE_CORNERS) == list)
			return role;
	}
	return ROLE_NONE;
}

static int header_property(struct ply *ply, struct text_span line)
{
	struct ply_property *property = &ply->property[ply->properties];
	const int at = ply->soup.lines.line;
	struct text_span word = text_word(&line);

	if (ply->properties == PROPERTIES_MAX)
		return header_refuse(ply, at, "expected at most %d properties", PROPERTIES_MAX);
	if (!ply->elements)
		return header_refuse(ply, at, "a property by itself, expected an element first");
	property->count = -1;
	if (text_is(word, "list")) {
		word = text_word(&line);
		property->count = type_of(word);
		if (property->count < 0 || property->count >= FIRST_FLOAT)
			return header_refuse(ply, at,
					     "a list counted in %.*s, expected whole numbers",
					     text_shown(word), word.at);
		word = text_word(&line);
	}
	property->type = type_of(word);
	if (property->type < 0)
		return header_refuse(ply, at, "property of type \"%.*s\", expected one of %s",
				     text_shown(word), word.at, types[0]);
	property->role = role_of(text_word(&line), property->count >= 0);
	ply->type[property->role] = property->type;
	ply->properties++;
	ply->element[ply->elements - 1].properties++;
	ply->element[ply->elements - 1].roles |= 1u << property->role;
	return 0;
}

static int header_element(struct ply *ply, struct text_span line)
{
	const struct text_span name = text_word(&line), word = text_word(&line);
	const int at = ply->soup.lines.line;
	struct text_span digits = word;
	int64_t count;

	if (!text_whole(&digits, &count) || !text_empty(digits) || count < 0 || count > INT_MAX)
		return header_refuse(ply, at, "element %.*s \"%.*s\", expected a number 0..%d",
				     text_shown(name), name.at, text_shown(word), word.at, INT_MAX);
	if (ply->elements == ELEMENTS_MAX)
		return header_refuse(ply, at, "expected at most %d elements", ELEMENTS_MAX);
	ply->element[ply->elements++] =
		(struct ply_element){.name = name,
				     .line = at,
				     .count = (size_t)count,
				     .property = &ply->property[ply->properties]};
	return 0;
}

/* MeshLab names textures in comments. */
static int header_comment(struct ply *ply, struct text_span line)
{
	const struct text_span word = text_word(&line), name = text_name(line);
	struct texture_name *texture = &ply->texture[ply->texture_count];

	if (!text_is_any_case(word, "TextureFile") || text_empty(name) ||
	    ply->texture_count == TEXTURES_MAX)
		return 0;
	*texture = (struct texture_name){ply->soup.path, ply->soup.lines.line, text_copy(name)};
	ply->texture_count++;
	return texture->name ? 0 : soup_lack(&ply->soup);
}

#define FORMATS "expected format ascii, binary_little_endian or binary_big_endian in the header"

static int header_format(struct ply *ply, struct text_span line)
{
	const struct text_span kind = text_word(&line);

	ply->ascii = text_is(kind, "ascii");
	ply->big_endian = text_is(kind, "binary_big_endian");
	return ply->ascii || ply->big_endian || text_is(kind, "binary_little_endian")
		       ? 0
		       : header_refuse(ply, ply->soup.lines.line, FORMATS);
}

/* Reads up to end_header. Skips words that it does not know. */
static int ply_read_header(struct ply *ply)
{
	static const struct {
		const char *word;
		int (*read)(struct ply *ply, struct text_span line);
	} lines[] = {{"format", header_format},
		     {"property", header_property},
		     {"element", header_element},
		     {"comment", header_comment}};
	const char *end = ply->soup.lines.rest.end, *fourth = ply->soup.lines.rest.at + 3;
	const bool macintosh = end - fourth > 1 && fourth[0] == '\r' && fourth[1] != '\n';
	struct text_span line;
	bool format = false;
	int err = 0;

	while (!err && text_next(&ply->soup.lines, &line)) {
		const char *const line_end = line.end;
		const struct text_span word = text_word(&line);

		if (text_is(word, "end_header") && format) {
			/* data may begin with a byte of "\n" */
			if (macintosh && line_end < end)
				ply->soup.lines.rest.at = line_end + 1;
			return 0;
		}
		format |= text_is(word, "format");
		/* the last line of a file that is cut is not whole; of a format that does not
		 * matter */
		for (size_t k = 0; k < (line_end < end ? LENGTH(lines) : 1) && !err; k++)
			if (text_is(word, lines[k].word))
				err = lines[k].read(ply, line);
	}
	if (err || !format)
		return err ? err : header_refuse(ply, ply->soup.lines.line, FORMATS);
	return fault_say(
		ply->soup.fault, -EBADMSG,
		"%s: no line end_header, expected one at the end of the header: damaged or cut short",
		ply->soup.path);
}

/* ---- rows ---- */

/* Says where a row is, and what is wrong there. */
static int ply_refuse(const struct ply *ply, const char *what, const char *expected)
{
	char place[16] = "";

	if (ply->ascii)
		snprintf(place, sizeof(place), ":%d", ply->soup.lines.line);
	return fault_say(ply->soup.fault, -EBADMSG,
			 "%s%s: %.*s %zu %s, expected %s: damaged or cut short", ply->soup.path,
			 place, text_shown(ply->of->name), ply->of->name.at, ply->row + 1, what,
			 expected);
}

static int ply_refuse_word(const struct ply *ply, struct text_span word, const char *after,
			   const char *expected)
{
	char what[128] = "ends here";

	if (!text_empty(word))
		snprintf(what, sizeof(what), "has \"%.*s\"%s", text_shown(word), word.at, after);
	return ply_refuse(ply, what, expected);
}

static int ply_cut(const struct ply *ply)
{
	return fault_say(ply->soup.fault, -EBADMSG,
			 "%s: it ends in %.*s %zu, expected %zu of them: damaged or cut short",
			 ply->soup.path, text_shown(ply->of->name), ply->of->name.at, ply->row + 1,
			 ply->of->count);
}

static double binary_value(const char *at, int type, bool big_endian)
{
	const int n = bytes_of[type];
	uint64_t bits = 0;
	uint32_t word;
	float single;
	double wide;

	for (int k = 0; k < n; k++)
		bits |= (uint64_t)(uint8_t)at[k] << 8 * (big_endian ? n - 1 - k : k);
	word = (uint32_t)bits;
	memcpy(&single, &word, sizeof(single));
	memcpy(&wide, &bits, sizeof(wide));
	if (type >= FIRST_FLOAT)
		return n == 4 ? (double)single : wide;
	return (double)bits - (type % 2 == 0 && bits >> (8 * n - 1) ? ldexp(1, 8 * n) : 0);
}

#define HOW_MANY "how many numbers follow"

static int ply_take(struct ply *ply, int type, double *value, const char *expected)
{
	struct text_span *data = &ply->soup.lines.rest;

	if (ply->ascii) {
		const struct text_span word = text_word(&ply->rest);

		return text_number(word, value) ? 0 : ply_refuse_word(ply, word, "", expected);
	}
	if (data->end - data->at < bytes_of[type])
		return ply_cut(ply);
	*value = binary_value(data->at, type, ply->big_endian);
	data->at += bytes_of[type];
	return 0;
}

static int ply_take_property(struct ply *ply, const struct ply_property *p)
{
	double count = 1, value;
	char what[64];
	int err = p->count >= 0 ? ply_take(ply, p->count, &count, HOW_MANY) : 0;

	if (!err &&
	    (!(count >= (p->role == ROLE_CORNERS)) || count > INT_MAX || count != floor(count))) {
		snprintf(what, sizeof(what), "has \"%.10g\"", count);
		return ply_refuse(ply, what, HOW_MANY);
	}
	ply->values[p->role] = 0;
	for (; count > 0 && !err; count--) {
		err = ply_take(ply, p->type, &value, "a number");
		if (err || p->role == ROLE_NONE)
			continue;
		if (!soup_room(&ply->value[p->role], ply->values[p->role], &ply->room[p->role],
			       sizeof(value)))
			return soup_lack(&ply->soup);
		ply->value[p->role][ply->values[p->role]++] = value;
	}
	return err;
}

/* Empty lines between rows do not count. */
static int ply_read_row(struct ply *ply)
{
	int err = 0;

	while (ply->ascii && text_empty(ply->rest))
		if (!text_next(&ply->soup.lines, &ply->rest))
			return ply_cut(ply);
	for (int k = 0; k < ply->of->properties && !err; k++)
		err = ply_take_property(ply, &ply->of->property[k]);
	return err;
}

/* ---- vertices ---- */

static void ply_values(const struct ply *ply, int role, int count, float *to)
{
	for (int k = 0; k < count; k++)
		to[k] = (float)ply->value[role + k][0];
}

/* What white has, or full alpha. A type of more than a byte does not tell. */
static double ply_full_colour(int type, double most)
{
	const double range = type < FIRST_FLOAT ? ldexp(1, 8 * bytes_of[type] - !(type % 2)) - 1
						: most;

	if (bytes_of[type] == 1 || most > 65535)
		return range;
	return type < FIRST_FLOAT ? fmin(range, soup_full_colour(fmax(most, 2)))
				  : soup_full_colour(most);
}

static void ply_colour(struct ply *ply, float colour[3])
{
	ply_values(ply, ROLE_COLOUR, 3, colour);
	if (has_roles(ply->of, ROLE_ALPHA, 1)) {
		ply->least_alpha = fmin(ply->least_alpha, ply->value[ROLE_ALPHA][0]);
		ply->most_alpha = fmax(ply->most_alpha, ply->value[ROLE_ALPHA][0]);
	}
}

/* Code values are sRGB. */
static void ply_decode_colours(const struct ply *ply, struct mesh *mesh)
{
	float most = 0;

	for (int pass = 0; pass < 2; pass++)
		for (int p = 0; p < mesh->part_count; p++) {
			const struct mesh_part *part = &mesh->parts[p];

			for (int v = 0; part->colour && v < part->vertices; v++)
				if (pass == 0)
					for (int c = 0; c < 3; c++)
						most = fmaxf(most, part->colour[v][c]);
				else
					soup_decode_colours(part->colour[v], 3,
							    ply_full_colour(ply->type[ROLE_COLOUR],
									    (double)most));
		}
}

static int ply_add_vertex(struct ply *ply)
{
	struct soup_corner *corner;

	if (!soup_room(&ply->vertex, ply->vertices, &ply->vertex_room, sizeof(*ply->vertex)))
		return soup_lack(&ply->soup);
	ply->vertex_has = (has_roles(ply->of, ROLE_NORMAL, 3) ? SOUP_NORMALS : 0) |
			  (has_roles(ply->of, ROLE_UV, 2) ? SOUP_UVS : 0) |
			  (has_roles(ply->of, ROLE_COLOUR, 3) ? SOUP_COLOURS : 0);
	corner = &ply->vertex[ply->vertices++];
	*corner = (struct soup_corner){.colour = {1, 1, 1}};
	for (int axis = 0; axis < 3; axis++) {
		corner->position[axis] = ply->value[ROLE_X + axis][0];
		if (!isfinite((float)corner->position[axis]))
			return fault_say(ply->soup.fault, -EDOM,
					 "%s: vertex %zu is not finite, expected numbers",
					 ply->soup.path, ply->row + 1);
	}
	if (ply->vertex_has & SOUP_NORMALS)
		ply_values(ply, ROLE_NORMAL, 3, corner->normal);
	if (ply->vertex_has & SOUP_UVS)
		ply_values(ply, ROLE_UV, 2, corner->uv);
	if (ply->vertex_has & SOUP_COLOURS)
		ply_colour(ply, corner->colour);
	return 0;
}

/* ---- faces ---- */

/* The texture of a face; -1: none. */
static int ply_texture(const struct ply *ply)
{
	const double said = has_roles(ply->of, ROLE_TEXTURE, 1) ? ply->value[ROLE_TEXTURE][0] : 0;

	return said >= 0 && said < ply->texture_count ? (int)said : -1;
}

/* Adds the corners of the list first .. first + count, which are in range. turned: in the order of
 * a strip's second triangle. */
static int ply_add_polygon(struct ply *ply, size_t first, size_t count, bool turned)
{
	const bool wedges = has_roles(ply->of, ROLE_UVS, 1) &&
			    ply->values[ROLE_UVS] >= 2 * (first + count);
	const bool coloured = has_roles(ply->of, ROLE_COLOUR, 3);
	unsigned has = ply->vertex_has | (wedges ? SOUP_UVS : 0) | (coloured ? SOUP_COLOURS : 0);
	const int texture = has & SOUP_UVS ? ply_texture(ply) : -1;

	for (size_t k = 0; k < count; k++) {
		const size_t at = first + (turned && k < 2 ? 1 - k : k);
		struct soup_corner *corner;

		if (!soup_room(&ply->corner, k, &ply->corner_room, sizeof(*ply->corner)))
			return soup_lack(&ply->soup);
		corner = &ply->corner[k];
		*corner = ply->vertex[(size_t)ply->value[ROLE_CORNERS][at]];
		if (!soup_has_normal(corner))
			has &= ~SOUP_NORMALS;
		for (size_t i = 0; i < 2 && wedges; i++)
			corner->uv[i] = (float)ply->value[ROLE_UVS][2 * at + i];
		if (coloured && !(ply->vertex_has & SOUP_COLOURS))
			ply_colour(ply, corner->colour);
	}
	if (!ply->soup.with_materials || texture >= 0)
		has &= ~SOUP_COLOURS;
	ply->colours |= has & SOUP_COLOURS;
	return soup_add(&ply->soup, ply->corner, (int)count,
			ply->soup.with_materials ? texture + 1 : 0, has);
}

static int check_corner(const struct ply *ply, double corner)
{
	char what[64], expected[64];

	if (corner >= 0 && corner < (double)ply->vertices && corner == floor(corner))
		return 0;
	snprintf(what, sizeof(what), "names vertex %.10g", corner);
	snprintf(expected, sizeof(expected), "less than %zu", ply->vertices);
	return ply_refuse(ply, what, expected);
}

/* A strip: each corner makes a triangle with the two before it; -1 begins another strip. */
static int ply_add_strip(struct ply *ply)
{
	size_t length = 0;
	int err = 0;

	for (size_t k = 0; k < ply->values[ROLE_CORNERS] && !err; k++) {
		const double corner = ply->value[ROLE_CORNERS][k];

		if (corner == -1) {
			length = 0;
			continue;
		}
		err = check_corner(ply, corner);
		length++;
		if (!err && length >= 3)
			err = ply_add_polygon(ply, k - 2, 3, length % 2 == 0);
	}
	return err;
}

static int ply_add_face(struct ply *ply)
{
	const size_t count = ply->values[ROLE_CORNERS];
	const struct text_span word = text_word(&ply->rest);
	int err = 0;

	if (!text_empty(word))
		return ply_refuse_word(ply, word, " after its vertices", "as many as it counts");
	for (size_t k = 0; k < count && !err; k++)
		err = check_corner(ply, ply->value[ROLE_CORNERS][k]);
	return err ? err : ply_add_polygon(ply, 0, count, false);
}

/* ---- the file ---- */

typedef int ply_add(struct ply *ply);

/* What adds faces of an element's rows; NULL: it has none. */
static ply_add *faces_of(const struct ply_element *element)
{
	if (!has_roles(element, ROLE_CORNERS, 1))
		return NULL;
	return text_is(element->name, "face")	     ? ply_add_face
	       : text_is(element->name, "tristrips") ? ply_add_strip
						     : NULL;
}

static int ply_read_element(struct ply *ply, int number, ply_add *add)
{
	int err = 0;

	ply->of = &ply->element[number];
	if (ply->of->count && !ply->of->properties)
		return header_refuse(ply, ply->of->line,
				     "element %.*s has no property, expected at least one",
				     text_shown(ply->of->name), ply->of->name.at);
	for (ply->row = 0; ply->row < ply->of->count && !err; ply->row++) {
		ply->rest = (struct text_span){NULL, NULL};
		err = ply_read_row(ply);
		if (!err && add)
			err = add(ply);
	}
	return err;
}

/* Reads vertices first, wherever they are. Where faces stand before them, all is read once more. */
static int ply_read_rows(struct ply *ply)
{
	const struct text_lines begin = ply->soup.lines;
	int vertices = 0, err = 0, first;
	bool again = false;

	while (vertices < ply->elements && !text_is(ply->element[vertices].name, "vertex"))
		again |= faces_of(&ply->element[vertices++]) != NULL;
	if (vertices < ply->elements && ply->element[vertices].properties &&
	    !has_roles(&ply->element[vertices], ROLE_X, 3))
		return fault_say(ply->soup.fault, -EBADMSG,
				 "%s: its vertices have no x, y and z, expected these properties",
				 ply->soup.path);
	for (int k = 0; k <= vertices && k < ply->elements && !err; k++)
		err = ply_read_element(ply, k, k == vertices ? ply_add_vertex : NULL);
	first = again ? 0 : vertices + 1;
	if (again)
		ply->soup.lines = begin;
	for (int k = first; k < ply->elements && !err; k++) {
		err = ply_read_element(ply, k, faces_of(&ply->element[k]));
		if (ply->element[k].count && text_is(ply->element[k].name, "edge"))
			left_out_add(&ply->soup.out, "edges", "mesh");
	}
	return err;
}

/* Material 0 has no texture, k + 1 has texture k. */
static int ply_add_materials(struct ply *ply)
{
	struct mesh *mesh = ply->soup.textures.mesh;
	int err = 0;

	mesh->materials = calloc((size_t)ply->texture_count + 1, sizeof(*mesh->materials));
	if (!mesh->materials)
		return soup_lack(&ply->soup);
	for (int k = -1; k < ply->texture_count && !err; k++) {
		struct material *m = &mesh->materials[mesh->material_count++];
		bool used = false;

		*m = soup_material(k >= 0 || ply->colours);
		for (int part = 0; part < mesh->part_count; part++)
			used |= mesh->parts[part].material == k + 1;
		if (k >= 0 && used)
			err = textures_get(&ply->soup.textures, TEXTURE_OF_COLOURS,
					   &ply->texture[k], NULL, TEXTURE_REPEAT, &m->texture);
	}
	if (ply->least_alpha < ply_full_colour(ply->type[ROLE_ALPHA], ply->most_alpha))
		left_out_add(&ply->soup.out, "alpha of vertices", "mesh");
	return err;
}

static int ply_read_file(struct ply *ply, double crease_deg)
{
	int err = ply_read_header(ply);

	err = err ? err : ply_read_rows(ply);
	err = err ? err : soup_finish(&ply->soup, crease_deg);
	if (!err)
		ply_decode_colours(ply, ply->soup.textures.mesh);
	return err || !ply->soup.with_materials ? err : ply_add_materials(ply);
}

static void ply_free(struct ply *ply)
{
	for (int k = 0; k < ROLE_COUNT; k++)
		free(ply->value[k]);
	for (int k = 0; k < ply->texture_count; k++)
		free((char *)ply->texture[k].name);
	free(ply->vertex);
	free(ply->corner);
	free(ply);
}

int ply_read(struct mesh *mesh, const char *path, double crease_deg, bool materials,
	     struct fault *fault)
{
	struct ply *ply = calloc(1, sizeof(*ply));
	int err;

	if (!ply)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	ply->least_alpha = INFINITY;
	err = soup_open(&ply->soup, mesh, path, materials, fault);
	err = soup_close(&ply->soup, err ? err : ply_read_file(ply, crease_deg));
	ply_free(ply);
	return err;
}
