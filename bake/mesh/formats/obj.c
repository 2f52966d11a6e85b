/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/mesh/formats/formats.h"
#include "bake/mesh/formats/soup.h"
#include "hal/base/log.h"

/* Rows of numbers: positions in double precision, texture coordinates, normals, colours. */
struct obj_rows {
	size_t bytes; /* of a row */
	char *value;
	size_t count, room;
	size_t seen; /* rows before the face that is being read */
};

enum obj_kind { OBJ_POSITION, OBJ_UV, OBJ_NORMAL, OBJ_KINDS };

static const struct obj_kind_of_row {
	const char *name, *word;
	int least, most; /* numbers of a line */
} kinds[OBJ_KINDS] = {
	{"vertex", "v", 3, 7}, {"texture coordinate", "vt", 1, 2}, {"normal", "vn", 3, 3}};

struct obj {
	struct soup soup;
	struct obj_rows rows[OBJ_KINDS];
	struct obj_rows colours; /* as many as positions; empty: none has one */
	struct obj_rows painted; /* the same by ZBrush's comments */
	struct mtl_library library;
	int *material; /* [library.count + 1]: that of the mesh, -1: not made yet. The last is for
			  faces without one */
	bool any_library;
	/* The first library that could not be opened; an error only if a material is not found
	 * elsewhere. NULL: none. */
	char *missing;
	int missing_line;
	int current;		    /* material that faces get, in the library */
	struct soup_corner *corner; /* of a face */
	size_t corner_room;
	bool bare;    /* faces with a texture, but without its coordinates */
	unsigned odd; /* bits of odd_words */
};

/* Statements that draw what is no surface of polygons. */
static const char *const odd_words[] = {"l", "p", "curv", "curv2", "surf"};
static const char *const odd_names[] = {"lines", "points", "curves", "curves", "curved surfaces"};

/* ---- numbers ---- */

static bool rows_add(struct obj_rows *rows, const void *value)
{
	if (!soup_room(&rows->value, rows->count, &rows->room, rows->bytes))
		return false;
	memcpy(rows->value + rows->count++ * rows->bytes, value, rows->bytes);
	return true;
}

/* Reads the numbers of a line, up to a comment. */
static int obj_numbers(const struct obj *obj, enum obj_kind kind, struct text_span line,
		       double *value)
{
	int count = 0;

	for (; count < kinds[kind].most; count++) {
		const struct text_span got = text_word(&line);
		if (count >= kinds[kind].least && (text_empty(got) || *got.at == '#'))
			break;
		if (!text_number(got, &value[count]))
			return fault_say(obj->soup.fault, -EBADMSG,
					 "%s:%d: %s has \"%.*s\", expected a number",
					 obj->soup.path, obj->soup.lines.line, kinds[kind].name,
					 text_shown(got), got.at);
		if (!isfinite((float)value[count]) && kind == OBJ_POSITION)
			return fault_say(obj->soup.fault, -EDOM,
					 "%s:%d: vertex %zu is not finite, expected numbers",
					 obj->soup.path, obj->soup.lines.line,
					 obj->rows[kind].count + 1);
	}
	return count;
}

/* Three more numbers behind a position are a colour, as many scanners write it. */
static int obj_colour(struct obj *obj, const float colour[3], bool said)
{
	static const float white[3] = {1, 1, 1};
	struct obj_rows *colours = &obj->colours;

	if (!said && !colours->count)
		return 0;
	while (colours->count + 1 < obj->rows[OBJ_POSITION].count)
		if (!rows_add(colours, white))
			return -ENOMEM;
	return rows_add(colours, said ? colour : white) ? 0 : -ENOMEM;
}

static int obj_row(struct obj *obj, enum obj_kind kind, struct text_span line)
{
	double value[7] = {0};
	float single[7];
	const int count = obj_numbers(obj, kind, line, value);

	if (count < 0)
		return count;
	for (int k = 0; k < 7; k++)
		single[k] = (float)value[k];
	if (!rows_add(&obj->rows[kind], kind == OBJ_POSITION ? (void *)value : single) ||
	    (kind == OBJ_POSITION && obj_colour(obj, single + count - 3, count >= 6) < 0))
		return soup_lack(&obj->soup);
	return 0;
}

/* ZBrush writes colours in comments, of up to 64 vertices each: two digits of a mask, and R G B. */
static int obj_painted(struct obj *obj, struct text_span line)
{
	const struct text_span word = text_word(&line);

	for (const char *at = word.at; word.end - at >= 8; at += 8) {
		float colour[3];

		for (int c = 0; c < 3; c++) {
			const char digits[3] = {at[2 + 2 * c], at[3 + 2 * c], '\0'};

			colour[c] = (float)strtoul(digits, NULL, 16);
		}
		if (!rows_add(&obj->painted, colour))
			return soup_lack(&obj->soup);
	}
	return 0;
}

/* ---- materials ---- */

static int obj_miss(struct obj *obj, struct text_span name)
{
	if (obj->missing)
		return 0;
	obj->missing = text_copy(name);
	obj->missing_line = obj->soup.lines.line;
	return obj->missing ? 0 : soup_lack(&obj->soup);
}

/* Reads a library; -ENOENT without a fault: there is none of this name. */
static int obj_open_library(struct obj *obj, struct text_span name)
{
	char path[PATH_MAX];
	char *text = text_copy(name);
	bool found;

	if (!text)
		return soup_lack(&obj->soup);
	found = beside_find(obj->soup.path, text, path);
	free(text);
	obj->library.line = obj->soup.lines.line;
	return found ? mtl_read(&obj->library, path, &obj->soup.textures.budget, obj->soup.fault)
		     : -ENOENT;
}

/* The rest of the line is the name of one library, which may have blanks, or of several. In place
 * of those that are missing counts the one that is named as the mesh. */
static int obj_libraries(struct obj *obj, struct text_span line)
{
	const struct text_span all = text_name(line);
	const char *slash = strrchr(obj->soup.path, '/'), *dot = strrchr(obj->soup.path, '.');
	const char *bare = slash ? slash + 1 : obj->soup.path;
	char own[PATH_MAX];
	int err = obj_open_library(obj, all), some = 0;

	obj->any_library = true;
	if (err != -ENOENT)
		return err;
	line = all;
	for (struct text_span word = text_word(&line); !text_empty(word); word = text_word(&line)) {
		err = obj_open_library(obj, word);
		if (err && err != -ENOENT)
			return err;
		some += !err;
		if (err && obj_miss(obj, some ? word : all) < 0)
			return -ENOMEM;
	}
	if (some || snprintf(own, sizeof(own), "%.*s.mtl", (int)((dot > bare ? dot : bare) - bare),
			     bare) >= (int)sizeof(own))
		return 0;
	err = obj_open_library(obj, (struct text_span){own, own + strlen(own)});
	if (!err)
		log_say_once(LOG_LEVEL_INFO, "%s: %.*s is taken from %s", obj->soup.path,
			     text_shown(all), all.at, own);
	return err == -ENOENT ? 0 : err;
}

static int obj_use(struct obj *obj, struct text_span line)
{
	const struct text_span name = text_name(line);

	if (!obj->soup.with_materials || !obj->any_library)
		return 0;
	obj->current = mtl_find(&obj->library, name, obj->soup.lines.line);
	if (obj->current >= 0)
		return 0;
	if (obj->missing)
		return fault_say(
			obj->soup.fault, -ENOENT,
			"%s:%d: mtllib %s: cannot be opened, expected it beside the mesh, or a material in the scene file",
			obj->soup.path, obj->missing_line, obj->missing);
	return fault_say(
		obj->soup.fault, -EINVAL,
		"%s:%d: usemtl %.*s: its libraries have no such material, expected newmtl %.*s in one, or a material in the scene file",
		obj->soup.path, obj->soup.lines.line, text_shown(name), name.at, text_shown(name),
		name.at);
}

/* Makes the material of the next faces when it is used first. */
static int obj_material(struct obj *obj)
{
	struct mesh *mesh = obj->soup.textures.mesh;
	struct material *m = &mesh->materials[mesh->material_count];

	if (obj->material[obj->current] >= 0)
		return 0;
	obj->material[obj->current] = mesh->material_count++;
	if (obj->current < obj->library.count)
		return mtl_make(&obj->library, obj->current, &obj->soup.textures, m,
				&obj->soup.out);
	*m = soup_material(obj->colours.count > 0);
	return 0;
}

/* ---- faces ---- */

/* Returns the row that an index names: 1 is the first row of the file, -1 the last before the
 * face. */
static const void *obj_find(const struct obj *obj, enum obj_kind kind, int64_t index)
{
	const struct obj_rows *rows = &obj->rows[kind];
	const int64_t at = index < 0 ? (int64_t)rows->seen + index : index - 1;

	if (at >= 0 && (uint64_t)at < rows->count)
		return rows->value + (size_t)at * rows->bytes;
	if (index)
		fault_say(
			obj->soup.fault, -EBADMSG,
			"%s:%d: face names %s %lld, but there are %zu %s, expected one of these: damaged or cut short",
			obj->soup.path, obj->soup.lines.line, kinds[kind].name, (long long)index,
			index < 0 ? rows->seen : rows->count, index < 0 ? "before it" : "in all");
	else
		fault_say(obj->soup.fault, -EBADMSG, "%s:%d: face names %s 0, expected 1 or more",
			  obj->soup.path, obj->soup.lines.line, kinds[kind].name);
	return NULL;
}

/* Reads a corner, "v", "v/vt", "v//vn" or "v/vt/vn". */
static int obj_corner(struct obj *obj, struct text_span word, struct soup_corner *corner,
		      unsigned *has)
{
	const struct text_span whole = word;
	const void *row[OBJ_KINDS] = {NULL};
	bool fine = true;

	for (int kind = 0; kind < OBJ_KINDS && fine && (kind == 0 || !text_empty(word)); kind++) {
		int64_t index;

		if (kind > 0 && *word.at++ != '/')
			fine = false;
		else if (text_whole(&word, &index))
			row[kind] = obj_find(obj, kind, index);
		else if (kind == 0)
			fine = false;
		else
			continue;
		if (fine && !row[kind])
			return -EBADMSG;
	}
	if (!fine || !text_empty(word))
		return fault_say(
			obj->soup.fault, -EBADMSG,
			"%s:%d: f has \"%.*s\", expected numbers of a vertex, a texture coordinate and a normal, such as 1/1/1",
			obj->soup.path, obj->soup.lines.line, text_shown(whole), whole.at);
	*corner = (struct soup_corner){.colour = {1, 1, 1}};
	memcpy(corner->position, row[OBJ_POSITION], sizeof(corner->position));
	if (row[OBJ_UV])
		memcpy(corner->uv, row[OBJ_UV], sizeof(corner->uv));
	if (row[OBJ_NORMAL])
		memcpy(corner->normal, row[OBJ_NORMAL], sizeof(corner->normal));
	if (!soup_has_normal(corner))
		*has &= ~SOUP_NORMALS;
	if (row[OBJ_UV])
		*has |= SOUP_UVS;
	if (obj->colours.count) {
		const struct obj_rows *rows = &obj->rows[OBJ_POSITION], *colours = &obj->colours;
		const size_t at = (size_t)((const char *)row[OBJ_POSITION] - rows->value);

		memcpy(corner->colour, colours->value + at / rows->bytes * colours->bytes,
		       colours->bytes);
	}
	return 0;
}

static int obj_face(struct obj *obj, struct text_span line)
{
	unsigned has = SOUP_NORMALS;
	size_t count = 0;
	const struct material *m;
	int err;

	for (struct text_span word = text_word(&line); !text_empty(word) && *word.at != '#';
	     word = text_word(&line)) {
		if (!soup_room(&obj->corner, count, &obj->corner_room, sizeof(*obj->corner)))
			return soup_lack(&obj->soup);
		err = obj_corner(obj, word, &obj->corner[count++], &has);
		if (err)
			return err;
	}
	if (!count)
		return fault_say(obj->soup.fault, -EBADMSG,
				 "%s:%d: f has no vertices, expected 3 or more", obj->soup.path,
				 obj->soup.lines.line);
	if (!obj->soup.with_materials)
		return soup_add(&obj->soup, obj->corner, (int)count, 0, has);
	err = obj_material(obj);
	if (err)
		return err;
	m = &obj->soup.textures.mesh->materials[obj->material[obj->current]];
	obj->bare |= m->texture && !(has & SOUP_UVS);
	if (obj->colours.count && !m->texture)
		has |= SOUP_COLOURS;
	return soup_add(&obj->soup, obj->corner, (int)count, obj->material[obj->current], has);
}

/* ---- the file ---- */

/* The first pass reads numbers and libraries; faces may name those that follow them. */
static int obj_line(struct obj *obj, bool first, struct text_span line)
{
	const struct text_span word = text_word(&line);

	for (int kind = 0; kind < OBJ_KINDS; kind++)
		if (text_is(word, kinds[kind].word)) {
			obj->rows[kind].seen += !first;
			return first ? obj_row(obj, (enum obj_kind)kind, line) : 0;
		}
	if (first && text_is(word, "#MRGB"))
		return obj_painted(obj, line);
	if (first)
		return obj->soup.with_materials && text_is_any_case(word, "mtllib")
			       ? obj_libraries(obj, line)
			       : 0;
	if (text_is(word, "f") || text_is(word, "fo"))
		return obj_face(obj, line);
	if (text_is_any_case(word, "usemtl"))
		return obj_use(obj, line);
	for (size_t k = 0; k < sizeof(odd_words) / sizeof(*odd_words); k++)
		obj->odd |= (unsigned)text_is(word, odd_words[k]) << k;
	return 0;
}

static int obj_pass(struct obj *obj, bool first)
{
	struct text_span line;
	int err = 0;

	text_begin(&obj->soup.lines, (const char *)obj->soup.file, obj->soup.bytes);
	while (!err && text_next_joined(&obj->soup.lines, &line))
		err = obj_line(obj, first, line);
	text_end(&obj->soup.lines);
	return err;
}

static bool obj_begin_materials(struct obj *obj)
{
	const size_t count = (size_t)obj->library.count + 1;

	obj->current = obj->library.count;
	obj->material = malloc(count * sizeof(*obj->material));
	obj->soup.textures.mesh->materials = calloc(count, sizeof(struct material));
	if (obj->material)
		memset(obj->material, 0xff, count * sizeof(*obj->material));
	return obj->material && obj->soup.textures.mesh->materials;
}

/* Colours are code values of sRGB. Those of vertices count before ZBrush's. */
static void obj_decode_colours(struct obj *obj)
{
	struct obj_rows *colours = &obj->colours;
	const bool painted = !colours->count && obj->painted.count >= obj->rows[0].count;
	const struct obj_rows none = *colours;
	float *value, most = 0;

	if (painted) {
		*colours = obj->painted;
		obj->painted = none;
	}
	value = (float *)(void *)colours->value;
	for (size_t k = 0; k < 3 * colours->count; k++)
		most = fmaxf(most, value[k]);
	soup_decode_colours(value, 3 * colours->count, painted ? 255 : soup_full_colour(most));
}

static int obj_read_text(struct obj *obj, double crease_deg)
{
	int err;

	/* Lines that are not known do not count: a picture, an archive or UTF-16 would be a mesh
	 * without faces. */
	if (obj->soup.bytes && memchr(obj->soup.file, '\0', obj->soup.bytes))
		return fault_say(obj->soup.fault, -EBADMSG,
				 "%s: holds a zero byte, expected the text of an OBJ",
				 obj->soup.path);
	err = obj_pass(obj, true);
	if (!err && !obj_begin_materials(obj))
		err = soup_lack(&obj->soup);
	if (err)
		return err;
	obj_decode_colours(obj);
	err = obj_pass(obj, false);
	for (size_t k = 0; k < sizeof(odd_words) / sizeof(*odd_words); k++)
		if (obj->odd & 1u << k)
			left_out_add(&obj->soup.out, odd_names[k], "mesh");
	if (obj->bare)
		left_out_add(&obj->soup.out, "textures without coordinates", "mesh");
	return err ? err : soup_finish(&obj->soup, crease_deg);
}

static void obj_free(struct obj *obj)
{
	for (int k = 0; k < OBJ_KINDS; k++)
		free(obj->rows[k].value);
	free(obj->colours.value);
	free(obj->painted.value);
	free(obj->material);
	free(obj->missing);
	free(obj->corner);
	mtl_free(&obj->library);
}

int obj_read(struct mesh *mesh, const char *path, double crease_deg, bool materials,
	     struct fault *fault)
{
	struct obj obj = {.rows = {{.bytes = 3 * sizeof(double)},
				   {.bytes = 2 * sizeof(float)},
				   {.bytes = 3 * sizeof(float)}},
			  .colours = {.bytes = 3 * sizeof(float)},
			  .painted = {.bytes = 3 * sizeof(float)}};
	int err = soup_open(&obj.soup, mesh, path, materials, fault);

	err = soup_close(&obj.soup, err ? err : obj_read_text(&obj, crease_deg));
	obj_free(&obj);
	return err;
}
