/* SPDX-License-Identifier: MIT */

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/mesh/formats/soup.h"
#include "hal/base/input.h"
#include "hal/base/log.h"

#define LIBRARY_MAX ((uint64_t)64 << 20) /* bytes */
#define A_BYTE 48.0			 /* memory that a byte of text takes at most */
#define PLASTIC 0.08f			 /* a coat's reflectance for Ks = 1, as in Blender */
#define UNSAID (-1.0f)

enum mtl_number { KD, KS = KD + 3, KA = KS + 3, NS = KA + 3, D, TR, ILLUM, PR, PM, MTL_NUMBERS };

enum mtl_map_kind {
	MAP_COLOUR,
	MAP_COVERAGE,
	MAP_ROUGHNESS,
	MAP_METALNESS,
	MAP_NORMALS,
	MAP_BUMPS,
	MAP_COUNT
};

struct mtl_map {
	char *name; /* NULL: none */
	int line;
	float scale[2], offset[2], strength;
	bool clamp;
};

struct mtl {
	char *name;
	char *by;     /* the library */
	bool blender; /* which has written it */
	float number[MTL_NUMBERS];
	struct mtl_map map[MAP_COUNT];
	unsigned left; /* bits of lefts */
	bool spectral;
	int since; /* line of the mesh that names the library */
};

/* ---- statements ---- */

static const char colours[] = "Kd Ks Ka", numbers[] = "Ns d Tr illum Pr Pm";
static const char *const maps[] = {"map_Kd map_d map_Pr map_Pm norm bump",
				   "- - - - map_Kn map_bump"};

/* What the bake leaves out, if it is above 0 or a map. */
static const struct mtl_left {
	const char *words, *what;
} lefts[] = {{"disp map_disp", "displacement maps"},
	     {"map_Ks map_Ns", "highlight maps"},
	     {"Ke map_Ke", "emission"},
	     {"Pc map_Pc", "clear coats"},
	     {"Ps map_Ps", "sheen"},
	     {"aniso", "anisotropy"},
	     {"decal", "decals"},
	     {"refl map_refl", "reflection maps"},
	     {"map_Ka", "ambient maps"}};

#define AMBIENT_MAPS 8

/* A library as it is read. */
struct mtl_text {
	const char *path;
	struct fault *fault;
	struct text_lines lines;
	struct mtl_library *library;
	struct mtl *mtl; /* that the statements are about */
};

static int mtl_lack(const struct mtl_text *text)
{
	return fault_say(text->fault, -ENOMEM, "%s: out of memory", text->path);
}

static bool take_finite(struct text_span *line, struct text_span *word, double *value)
{
	*word = text_word(line);
	return text_number(*word, value) && isfinite(*value);
}

/* Reads a number, or a grey or three channels of 0..1. Colours by spectral curves are left out. */
static int read_numbers(struct mtl_text *text, float *to, int most, struct text_span word,
			struct text_span line)
{
	struct text_span got, ahead = line;
	double value;

	got = text_word(&ahead);
	if (most == 3 && (text_is_any_case(got, "spectral") || text_is(got, "xyz"))) {
		text->mtl->spectral = true;
		return 0;
	}
	if (text_is_any_case(got, "-halo"))
		line = ahead;
	for (int c = 0; c < most; c++) {
		if (!take_finite(&line, &got, &value)) {
			if (c != 1 || !text_empty(got))
				return fault_say(text->fault, -EBADMSG,
						 "%s:%d: %.*s \"%.*s\", expected %s", text->path,
						 text->lines.line, text_shown(word), word.at,
						 text_shown(got), got.at,
						 most == 3 ? "one or three numbers" : "a number");
			to[2] = to[1] = to[0];
			return 0;
		}
		to[c] = fmaxf(most == 3 ? fminf((float)value, 1) : (float)value, 0);
	}
	return 0;
}

/* Takes an option and what follows it: numbers as far as there are some, or one word. The last word
 * of a line is the name. False: there is no option. */
static bool map_take_option(struct mtl_map *map, struct text_span *line)
{
	/* those that numbers follow: none, 1, 2, 3 */
	static const char *const options[] = {
		"-clamp -blendu -blendv -cc -imfchan -type -colorspace", "-bm -boost",
		"-mm -texres", "-s -o -t"};
	struct text_span rest = *line, option = text_word(&rest), ahead = rest, word;
	int most = 3, taken = 0;
	double value[3];

	while (most >= 0 && text_place(option, options[most]) < 0)
		most--;
	if (most < 0)
		return false;
	for (; taken < most && take_finite(&ahead, &word, &value[taken]); taken++)
		rest = ahead;
	if (most == 0)
		word = text_word(&rest);
	for (int k = 0; k < 2 && k < taken && most == 3; k++)
		if (text_place(option, "-s -o") >= 0)
			(text_is_any_case(option, "-s") ? map->scale
							: map->offset)[k] = (float)value[k];
	if (taken && text_is_any_case(option, "-bm"))
		map->strength = (float)value[0];
	if (text_is_any_case(option, "-clamp"))
		map->clamp = text_is_any_case(word, "on");
	*line = rest;
	return true;
}

/* Without a name a map is as good as none: some programs write so. */
static int read_map(struct mtl_text *text, struct mtl_map *map, struct text_span line)
{
	struct text_span name;

	free(map->name);
	*map = (struct mtl_map){.line = text->lines.line, .scale = {1, 1}, .strength = 1};
	while (map_take_option(map, &line))
		;
	name = text_name(line);
	if (name.end - name.at > 2 && *name.at == '"' && name.end[-1] == '"') {
		name.at++;
		name.end--;
	}
	if (text_empty(name))
		return 0;
	map->name = text_copy(name);
	return map->name ? 0 : mtl_lack(text);
}

/* Whether a statement says more than 0: a number, or a name. */
static bool says_something(struct text_span line)
{
	struct text_span word;
	double value;

	while (!text_empty(word = text_word(&line)) && *word.at != '#')
		if (!text_number(word, &value) || value > 0)
			return true;
	return false;
}

static int read_statement(struct mtl_text *text, struct text_span line)
{
	const struct text_span word = text_word(&line);
	struct mtl *mtl = text->mtl;
	int at;

	if ((at = text_place(word, colours)) >= 0)
		return read_numbers(text, &mtl->number[KD + 3 * at], 3, word, line);
	if ((at = text_place(word, numbers)) >= 0)
		return read_numbers(text, &mtl->number[NS + at], 1, word, line);
	for (int k = 0; k < 2; k++)
		if ((at = text_place(word, maps[k])) >= 0)
			return read_map(text, &mtl->map[at], line);
	for (size_t k = 0; k < sizeof(lefts) / sizeof(*lefts); k++)
		if (text_place(word, lefts[k].words) >= 0)
			mtl->left |= (unsigned)says_something(line) << k;
	return 0;
}

/* ---- the library ---- */

static int library_add(struct mtl_text *text, struct text_span name, bool blender)
{
	struct mtl_library *library = text->library;
	struct mtl *grown = realloc(library->materials,
				    ((size_t)library->count + 1) * sizeof(*grown));

	if (!grown)
		return mtl_lack(text);
	library->materials = grown;
	text->mtl = &grown[library->count++];
	*text->mtl = (struct mtl){.name = text_copy(name),
				  .by = strdup(text->path),
				  .blender = blender,
				  .since = library->line};
	for (int k = 0; k < MTL_NUMBERS; k++)
		text->mtl->number[k] = UNSAID;
	return text->mtl->name && text->mtl->by ? 0 : mtl_lack(text);
}

/* Tr should be 1 - d, but MeshLab, OpenMVS and OpenDroneMap have written d. A library tells by
 * materials that say both, or by a Tr of 0 or 1, since no writer means a surface that is not there.
 * Where it tells nothing, or both, its comment counts. */
static void library_settle_tr(struct mtl_library *library, int first, bool meshlab)
{
	bool votes[2] = {false, false}; /* for 1 - d, for d */
	bool is_d = meshlab;

	for (int pass = 0; pass < 2 && votes[0] == votes[1]; pass++)
		for (int k = first; k < library->count; k++) {
			const float *number = library->materials[k].number, tr = number[TR];
			const float d = pass == 0 ? number[D] : 1;

			if (tr < 0 || d < 0 || (pass == 1 && number[D] >= 0))
				continue;
			votes[0] |= fabsf(1 - tr - d) < 0.01f && fabsf(tr - d) > 0.01f;
			votes[1] |= fabsf(tr - d) < 0.01f && fabsf(1 - tr - d) > 0.01f;
		}
	if (votes[0] != votes[1])
		is_d = votes[1];
	for (int k = first; k < library->count; k++) {
		float *number = library->materials[k].number;

		if (number[D] < 0 && number[TR] >= 0)
			number[D] = is_d ? number[TR] : fmaxf(1 - number[TR], 0);
	}
}

int mtl_read(struct mtl_library *library, const char *path, struct budget *budget,
	     struct fault *fault)
{
	static const char mark[] = "# Blender ", other_mark[] = "# Converted by Meshlab";
	const int first = library->count;
	struct mtl_text text = {.path = path, .fault = fault, .library = library};
	struct text_span line;
	uint8_t *file;
	size_t bytes;
	bool blender = false, meshlab = false, known = false;
	int err;

	if (library->count && !strcmp(library->materials[library->count - 1].by, path))
		return 0;
	for (int k = 0; k < library->count && !known; k++)
		known = strcmp(library->materials[k].by, path) == 0;
	err = input_read(path, LIBRARY_MAX, &file, &bytes, fault);
	if (err)
		return err;
	budget->file_bytes += known ? 0 : bytes;
	err = budget_take(budget, A_BYTE * (double)bytes, path, fault);
	text_begin(&text.lines, (const char *)file, bytes);
	while (!err && text_next_joined(&text.lines, &line)) {
		struct text_span rest = line;

		blender |= text_begins(line, mark);
		meshlab |= text_begins(line, other_mark);
		if (text_is_any_case(text_word(&rest), "newmtl"))
			err = library_add(&text, text_name(rest), blender);
		else if (text.mtl)
			err = read_statement(&text, line);
	}
	text_end(&text.lines);
	free(file);
	library_settle_tr(library, first, meshlab);
	return err;
}

int mtl_find(const struct mtl_library *library, struct text_span name, int line)
{
	const struct mtl *of = library->materials;
	int found = -1;

	for (int pass = 0; pass < 2 && found < 0; pass++)
		for (int k = 0; k < library->count; k++)
			if ((pass ? text_is_any_case : text_is)(name, of[k].name) &&
			    (found < 0 || (of[k].since > of[found].since && of[k].since <= line)))
				found = k;
	return found;
}

void mtl_free(struct mtl_library *library)
{
	for (int k = 0; k < library->count; k++) {
		for (int map = 0; map < MAP_COUNT; map++)
			free(library->materials[k].map[map].name);
		free(library->materials[k].name);
		free(library->materials[k].by);
	}
	free(library->materials);
	*library = (struct mtl_library){.count = 0};
}

/* ---- what it means ---- */

static float mean_of(const float c[3])
{
	return (c[0] + c[1] + c[2]) / 3;
}

static float within_1(float value)
{
	return fminf(fmaxf(value, 0), 1);
}

/* Roughness by Ns, where Pr does not say it: GGX of the same width as Phong's lobe has
 * alpha^2 = 2 / (n + 2). */
static float mtl_roughness(const struct mtl *mtl)
{
	const float n = mtl->number[NS];

	if (mtl->number[PR] >= 0)
		return within_1(mtl->number[PR]);
	if (n < 0)
		return 0.5f;
	return within_1(mtl->blender ? 1 - sqrtf(fminf(n, 1000) / 1000)
				     : sqrtf(sqrtf(2 / (n + 2))));
}

/* Reflectance of what is no metal; Ks is 1/2 where it is not said. */
static float mtl_plastic(const struct mtl *mtl)
{
	return PLASTIC * (mtl->number[KS] >= 0 ? mean_of(&mtl->number[KS]) : 0.5f);
}

/* As glTF: a metal's colour is its reflectance, and it has no base. */
static void set_metallic(struct material *m, float plastic, float metalness)
{
	m->metal = rgb_scale(m->colour, metalness);
	for (int c = 0; c < 3; c++)
		m->specular.c[c] = plastic * (1 - metalness) + m->metal.c[c];
	m->colour = rgb_scale(m->colour, 1 - metalness);
}

/* The sum of what base and mirror reflect is Kd + Ks, but at most 1. */
static void set_mirror(struct material *m, const float ks[3])
{
	float most = 0;

	for (int c = 0; c < 3; c++) {
		m->specular.c[c] = fminf(ks[c], 1 - m->colour.c[c]);
		most = fmaxf(most, m->specular.c[c]);
	}
	for (int c = 0; c < 3 && most < 1; c++)
		m->colour.c[c] = fminf(m->colour.c[c] / (1 - most), 1);
}

static void set_surface(const struct mtl *mtl, struct material *m)
{
	const float illum = mtl->number[ILLUM], *ks = &mtl->number[KS], *ka = &mtl->number[KA];
	const bool mirror = illum == 3 || illum == 8;

	m->kind = MATERIAL_GLOSSY;
	m->roughness = mtl_roughness(mtl);
	if (mtl->number[PR] >= 0 || mtl->number[PM] >= 0)
		set_metallic(m, mtl_plastic(mtl), within_1(mtl->number[PM]));
	else if (mtl->blender && (mirror || illum == 6) && ka[0] >= 0)
		set_metallic(m, mtl_plastic(mtl), mean_of(ka));
	else if (mean_of(ks) <= 0 || illum == 0 || illum == 1 || illum == 10)
		*m = (struct material){.ior = m->ior, .alpha = m->alpha, .colour = m->colour};
	else if (mirror)
		set_mirror(m, ks);
	else
		m->specular = rgb_make(PLASTIC * ks[0], PLASTIC * ks[1], PLASTIC * ks[2]);
}

/* Reads a texture of two maps; without either there is none. */
static int use_maps(const struct mtl *mtl, struct textures *textures, enum texture_kind kind,
		    enum mtl_map_kind first, enum mtl_map_kind second, struct texture_use *use)
{
	const struct mtl_map *a = &mtl->map[first], *b = &mtl->map[second], *of = a->name ? a : b;
	const struct texture_name name[2] = {{a->name ? mtl->by : NULL, a->line, a->name},
					     {b->name ? mtl->by : NULL, b->line, b->name}};

	*use = (struct texture_use){
		.place = {of->scale[0], 0, of->offset[0], 0, of->scale[1], of->offset[1]},
	};
	if (!of->name)
		return 0;
	return textures_get(textures, kind, &name[0], kind == TEXTURE_OF_DATA ? NULL : &name[1],
			    of->clamp ? TEXTURE_CLAMP : TEXTURE_REPEAT, &use->texture);
}

/* Roughness and metalness of a texture. The values of the material become its means. */
static int add_surface(const struct mtl *mtl, struct textures *textures, struct material *m)
{
	const float plastic = mtl_plastic(mtl);
	struct surface_map *map = &m->map;
	double sum[2] = {0, 0};
	const struct image *image;
	size_t pixels;
	int err = use_maps(mtl, textures, TEXTURE_OF_SURFACES, MAP_ROUGHNESS, MAP_METALNESS,
			   &map->use);

	if (err || !map->use.texture)
		return err;
	map->base = mtl->number[KD] >= 0 ? m->colour : rgb_make(1, 1, 1);
	map->specular = rgb_make(plastic, plastic, plastic);
	map->metallic = mtl->map[MAP_METALNESS].name ? 1 : within_1(mtl->number[PM]);
	map->roughness = mtl->map[MAP_ROUGHNESS].name ? 1 : mtl_roughness(mtl);
	image = &map->use.texture->image;
	pixels = (size_t)image->width * (size_t)image->height;
	for (size_t k = 0; k < 2 * pixels; k++)
		sum[k % 2] += image->u8[3 * (k / 2) + 1 + k % 2] / 255.0;
	m->kind = MATERIAL_GLOSSY;
	m->colour = map->base;
	m->roughness = map->roughness * (float)(sum[0] / (double)pixels);
	set_metallic(m, plastic, map->metallic * (float)(sum[1] / (double)pixels));
	return 0;
}

/* Many programs, Blender among them, write maps of normals as bump maps. Heights of the format have
 * no unit, so they are left out, as is a bump map that is missing. */
static int add_normals(const struct mtl *mtl, struct textures *textures, struct material *m,
		       struct left_out *out)
{
	const bool heights = !mtl->map[MAP_NORMALS].name;
	const enum mtl_map_kind kind = heights ? MAP_BUMPS : MAP_NORMALS;
	int err = use_maps(mtl, textures, TEXTURE_OF_DATA, kind, kind, &m->bumps);

	if (heights && (err || (m->bumps.texture && !texture_has_normals(m->bumps.texture)))) {
		m->bumps.texture = NULL;
		left_out_add(out, "bump maps", "material");
		return err == -ENOMEM ? err : 0;
	}
	if (m->bumps.texture)
		m->bump_scale = mtl->map[kind].strength;
	return err;
}

static void leave_out(const struct mtl *mtl, const struct material *m, struct left_out *out)
{
	const float illum = mtl->number[ILLUM];
	const bool refracts = illum == 4 || illum == 6 || illum == 7 || illum == 9;
	const struct {
		const char *what;
		bool found;
	} others[] = {{"spectral curves", mtl->spectral},
		      {"invisible shadow catchers", illum == 10},
		      {"alpha of colour maps",
		       m->alpha_mode == ALPHA_OPAQUE && m->texture && m->texture->image.alpha},
		      {"refraction", m->alpha < 1 && !mtl->blender && refracts}};
	unsigned left = mtl->left;

	if (mtl->map[MAP_COLOUR].name)
		left &= ~(1u << AMBIENT_MAPS); /* most have the same map for both */
	for (size_t k = 0; k < sizeof(lefts) / sizeof(*lefts); k++)
		if (left >> k & 1)
			left_out_add(out, lefts[k].what, "material");
	for (size_t k = 0; k < sizeof(others) / sizeof(*others); k++)
		if (others[k].found)
			left_out_add(out, others[k].what, "material");
}

int mtl_make(const struct mtl_library *library, int number, struct textures *textures,
	     struct material *m, struct left_out *out)
{
	const struct mtl *mtl = &library->materials[number];
	const float *kd = &mtl->number[KD], d = mtl->number[D];
	int err;

	*m = soup_material(mtl->map[MAP_COLOUR].name);
	/* beside a picture Maya writes black, which Blender overlooks too */
	if (kd[0] >= 0 && (mean_of(kd) > 0 || !mtl->map[MAP_COLOUR].name))
		m->colour = rgb_make(kd[0], kd[1], kd[2]);
	if (d >= 0)
		m->alpha = within_1(d);
	err = add_surface(mtl, textures, m);
	if (!m->map.use.texture)
		set_surface(mtl, m);
	if (m->alpha < 1 || mtl->map[MAP_COVERAGE].name)
		m->alpha_mode = ALPHA_BLEND;
	if (!err)
		err = use_maps(mtl, textures, TEXTURE_OF_COLOURS, MAP_COLOUR, MAP_COVERAGE,
			       &m->placed);
	m->texture = m->placed.texture;
	if (!err)
		err = add_normals(mtl, textures, m, out);
	if (err)
		return err;
	if (m->alpha <= 0)
		log_warning_once("%s: material %s is wholly transparent, as d or Tr says", mtl->by,
				 mtl->name);
	leave_out(mtl, m, out);
	return 0;
}
