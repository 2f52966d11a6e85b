/* SPDX-License-Identifier: MIT */
#include <endian.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "bake/mesh/formats/formats.h"
#include "bake/mesh/formats/soup.h"

/* A binary file: a header, the number of triangles, and for each a normal, three corners and two
 * bytes that some programs use for a colour. */
#define HEADER_BYTES 84
#define TRIANGLE_BYTES 50

struct stl {
	struct soup soup;
	bool colours;
};

static uint32_t stl_word(const char *at)
{
	uint32_t word;

	memcpy(&word, at, sizeof(word));
	return le32toh(word);
}

/* Binary files may begin with "solid" like text. What counts is whether the triangles that are
 * announced fit; bytes may follow them. */
static bool stl_is_binary(const struct soup *soup)
{
	const char *at = (const char *)soup->file;
	const uint64_t bytes = soup->bytes;

	if (bytes < HEADER_BYTES)
		return false;
	if (strncasecmp(at, "solid", 5) != 0)
		return true;
	return HEADER_BYTES + (uint64_t)TRIANGLE_BYTES * stl_word(at + 80) <= bytes &&
	       (memchr(at, '\0', HEADER_BYTES) || !memmem(at, bytes, "facet", 5));
}

static int stl_corner(const struct stl *stl, struct soup_corner *corner, int line, uint64_t vertex)
{
	char place[16] = "";

	for (int axis = 0; axis < 3; axis++)
		if (!isfinite((float)corner->position[axis])) {
			if (line)
				snprintf(place, sizeof(place), ":%d", line);
			return fault_say(stl->soup.fault, -EDOM,
					 "%s%s: vertex %llu is not finite, expected numbers",
					 stl->soup.path, place, (unsigned long long)vertex + 1);
		}
	return 0;
}

static int stl_read_binary(struct stl *stl)
{
	const char *at = (const char *)stl->soup.file + HEADER_BYTES;
	const uint32_t count = stl_word(at - 4);
	int err = 0;

	if (HEADER_BYTES + (uint64_t)TRIANGLE_BYTES * count > stl->soup.bytes)
		return fault_say(
			stl->soup.fault, -EBADMSG,
			"%s: it ends in triangle %zu, expected %u of them: damaged or cut short",
			stl->soup.path, (stl->soup.bytes - HEADER_BYTES) / TRIANGLE_BYTES + 1,
			count);
	for (uint32_t t = 0; t < count && !err; t++, at += TRIANGLE_BYTES) {
		struct soup_corner corner[3] = {{.uv = {0}}};

		for (int k = 0; k < 3 && !err; k++) {
			for (int axis = 0; axis < 3; axis++) {
				const uint32_t word = stl_word(at + 12 + 12 * k + 4 * axis);

				float value;

				memcpy(&value, &word, sizeof(value));
				corner[k].position[axis] = (double)value;
			}
			err = stl_corner(stl, &corner[k], 0, 3 * (uint64_t)t + (uint64_t)k);
		}
		stl->colours |= at[48] || at[49];
		if (!err)
			err = soup_add(&stl->soup, corner, 3, 0, 0);
	}
	return err;
}

/* Reads the three numbers of a vertex. */
static int stl_vertex(const struct stl *stl, struct text_span line, int number,
		      struct soup_corner *corner)
{
	for (int axis = 0; axis < 3; axis++) {
		const struct text_span got = text_word(&line);

		if (!text_number(got, &corner->position[axis]))
			return fault_say(stl->soup.fault, -EBADMSG,
					 "%s:%d: vertex has \"%.*s\", expected a number",
					 stl->soup.path, number, text_shown(got), got.at);
	}
	return stl_corner(stl, corner, number, 0);
}

/* A loop of vertices is a face; other words only stand around them. */
static int stl_read_text(struct stl *stl, struct text_lines *lines)
{
	struct soup_corner corner[3] = {{.uv = {0}}};
	struct text_span line;
	int count = 0, err = 0;
	bool solid = false;

	while (!err && text_next(lines, &line)) {
		const struct text_span word = text_word(&line);

		solid |= text_is_any_case(word, "solid");
		if (text_is_any_case(word, "vertex")) {
			if (count == 3)
				return fault_say(stl->soup.fault, -EBADMSG,
						 "%s:%d: a fourth vertex, expected endloop",
						 stl->soup.path, lines->line);
			err = stl_vertex(stl, line, lines->line, &corner[count++]);
		} else if (text_is_any_case(word, "endloop")) {
			if (count != 3)
				return fault_say(stl->soup.fault, -EBADMSG,
						 "%s:%d: endloop after %d vertices, expected 3",
						 stl->soup.path, lines->line, count);
			err = soup_add(&stl->soup, corner, 3, 0, 0);
			count = 0;
		}
	}
	if (!err && (!solid || count))
		err = fault_say(
			stl->soup.fault, -EBADMSG,
			solid ? "%s:%d: it ends within a face: damaged or cut short"
			      : "%s:%d: no line solid and no binary STL, expected one of the two",
			stl->soup.path, lines->line);
	return err;
}

int stl_read(struct mesh *mesh, const char *path, double crease_deg, bool materials,
	     struct fault *fault)
{
	struct stl stl = {.colours = false};
	int err = soup_open(&stl.soup, mesh, path, materials, fault);

	if (!err)
		err = stl_is_binary(&stl.soup) ? stl_read_binary(&stl)
					       : stl_read_text(&stl, &stl.soup.lines);
	err = err ? err : soup_finish(&stl.soup, crease_deg);
	if (!err && materials) {
		mesh->materials = calloc(1, sizeof(*mesh->materials));
		if (!mesh->materials)
			return soup_close(&stl.soup, soup_lack(&stl.soup));
		mesh->materials[0] = soup_material(false);
		mesh->material_count = 1;
		if (stl.colours)
			left_out_add(&stl.soup.out, "colours of triangles", "mesh");
	}
	return soup_close(&stl.soup, err);
}
