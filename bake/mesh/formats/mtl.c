/* SPDX-License-Identifier: MIT */
#include "bake/mesh/formats/mtl.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/mesh/plain_file.h"
#include "hal/base/log.h"

#define LIBRARY_MAX ((uint64_t)64 << 20) /* bytes */
#define PLASTIC 0.08f			 /* a coat's reflectance for Ks = 1, as in Blender */
#define UNSAID (-1.0f)

enum mtl_map_kind {
	MAP_COLOUR,
	MAP_COVERAGE,
	MAP_ROUGHNESS,
	MAP_METALNESS,
	MAP_NORMALS,
	MAP_BUMPS, /* normals, or heights */
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
	float kd[3], ks[3], ka[3];
	float exponent, coverage, see_through, roughness, metalness, illum;
	struct mtl_map map[MAP_COUNT];
	unsigned left; /* bits of left_words */
};

/* ---- statements ---- */

/* What the bake leaves out. */
static const char *const left_words[] = {
	"bump maps",
	"displacement maps",
	"highlight maps",
	"emission",
	"clear coats",
	"sheen",
	"anisotropy",
	"decals",
	"reflection maps",
	"spectral curves",
	"invisible shadow catchers",
	"alpha of colour maps",
	"refraction",
	"ambient maps",
};

enum left_kind {
	LEFT_BUMPS,
	LEFT_DISPLACEMENT,
	LEFT_HIGHLIGHTS,
	LEFT_EMISSION,
	LEFT_COAT,
	LEFT_SHEEN,
	LEFT_ANISOTROPY,
	LEFT_DECALS,
	LEFT_REFLECTION,
	LEFT_SPECTRA,
	LEFT_CATCHER,
	LEFT_ALPHA,
	LEFT_REFRACTION,
	LEFT_AMBIENT,
};

enum mtl_value { VALUE_COLOUR, VALUE_NUMBER, VALUE_MAP, VALUE_LEFT, VALUE_LEFT_MAP };

static const struct mtl_statement {
	const char *word;
	enum mtl_value value;
	size_t at; /* of a colour or number: offset in struct mtl; else a kind of map or of left_words */
} statements[] = {
	{"Kd", VALUE_COLOUR, offsetof(struct mtl, kd)},
	{"Ks", VALUE_COLOUR, offsetof(struct mtl, ks)},
	{"Ka", VALUE_COLOUR, offsetof(struct mtl, ka)},
	{"Ns", VALUE_NUMBER, offsetof(struct mtl, exponent)},
	{"d", VALUE_NUMBER, offsetof(struct mtl, coverage)},
	{"Tr", VALUE_NUMBER, offsetof(struct mtl, see_through)},
	{"illum", VALUE_NUMBER, offsetof(struct mtl, illum)},
	{"Pr", VALUE_NUMBER, offsetof(struct mtl, roughness)},
	{"Pm", VALUE_NUMBER, offsetof(struct mtl, metalness)},
	{"Ke", VALUE_LEFT, LEFT_EMISSION},
	{"Ps", VALUE_LEFT, LEFT_SHEEN},
	{"Pc", VALUE_LEFT, LEFT_COAT},
	{"aniso", VALUE_LEFT, LEFT_ANISOTROPY},
	{"map_Kd", VALUE_MAP, MAP_COLOUR},
	{"map_d", VALUE_MAP, MAP_COVERAGE},
	{"map_Pr", VALUE_MAP, MAP_ROUGHNESS},
	{"map_Pm", VALUE_MAP, MAP_METALNESS},
	{"norm", VALUE_MAP, MAP_NORMALS},
	{"map_Kn", VALUE_MAP, MAP_NORMALS},
	{"map_Bump", VALUE_MAP, MAP_BUMPS},
	{"bump", VALUE_MAP, MAP_BUMPS},
	{"disp", VALUE_LEFT_MAP, LEFT_DISPLACEMENT},
	{"map_disp", VALUE_LEFT_MAP, LEFT_DISPLACEMENT},
	{"map_Ks", VALUE_LEFT_MAP, LEFT_HIGHLIGHTS},
	{"map_Ns", VALUE_LEFT_MAP, LEFT_HIGHLIGHTS},
	{"map_Ke", VALUE_LEFT_MAP, LEFT_EMISSION},
	{"map_Ka", VALUE_LEFT_MAP, LEFT_AMBIENT},
	{"map_Ps", VALUE_LEFT_MAP, LEFT_SHEEN},
	{"map_Pc", VALUE_LEFT_MAP, LEFT_COAT},
	{"decal", VALUE_LEFT_MAP, LEFT_DECALS},
	{"refl", VALUE_LEFT_MAP, LEFT_REFLECTION},
	{"map_refl", VALUE_LEFT_MAP, LEFT_REFLECTION},
};

/* Options of a texture, and the most numbers or words that follow. */
static const struct mtl_option {
	const char *word;
	int most;
	bool numbers; /* only as many as are numbers */
} options[] = {
	{"-s", 3, true},       {"-o", 3, true},		  {"-t", 3, true},
	{"-mm", 2, true},      {"-bm", 1, true},	  {"-boost", 1, true},
	{"-texres", 2, true},  {"-clamp", 1, false},	  {"-blendu", 1, false},
	{"-blendv", 1, false}, {"-cc", 1, false},	  {"-imfchan", 1, false},
	{"-type", 1, false},   {"-colorspace", 1, false},
};

static int mtl_expect(const char *path, int line, struct text_span word, const char *expected,
		      struct text_span got, struct fault *fault)
{
	return fault_say(fault, -EBADMSG, "%s:%d: %.*s \"%.*s\", expected %s", path, line,
			 text_shown(word), word.at, text_shown(got), got.at, expected);
}

static bool mtl_finite(struct text_span word, double *value)
{
	return text_number(word, value) && isfinite(*value);
}

/* Reads a grey or three channels, 0..1. Colours by spectral curves are left out. */
static int mtl_colour(struct mtl *mtl, float colour[3], struct text_span word,
		      struct text_span line, const char *path, int number, struct fault *fault)
{
	int count = 0;
	double value;

	for (; count < 3; count++) {
		const struct text_span got = text_word(&line);

		if (count == 0 && (text_is_any_case(got, "spectral") || text_is(got, "xyz"))) {
			mtl->left |= 1u << LEFT_SPECTRA;
			return 0;
		}
		if (!mtl_finite(got, &value)) {
			if (count == 1 && text_empty(got))
				break;
			return mtl_expect(path, number, word, "one or three numbers", got, fault);
		}
		colour[count] = value > 0 ? fminf((float)value, 1) : 0;
	}
	for (; count < 3; count++)
		colour[count] = colour[0];
	return 0;
}

static void map_option(struct mtl_map *map, struct text_span option, const double *value, int count,
		       struct text_span last)
{
	float *pair = text_is(option, "-s")   ? map->scale
		      : text_is(option, "-o") ? map->offset
					      : NULL;

	for (int k = 0; k < 2 && k < count && pair; k++)
		pair[k] = (float)value[k];
	if (text_is(option, "-bm") && count)
		map->strength = (float)value[0];
	if (text_is(option, "-clamp"))
		map->clamp = text_is_any_case(last, "on");
}

/* Takes an option and what follows it; false: there is none. */
static bool map_take_option(struct mtl_map *map, struct text_span *line)
{
	struct text_span rest = *line, word = text_word(&rest), ahead, last = word;
	const struct mtl_option *option = NULL;
	double value[3];
	int count = 0;

	for (size_t k = 0; k < sizeof(options) / sizeof(*options); k++)
		if (text_is_any_case(word, options[k].word))
			option = &options[k];
	if (!option)
		return false;
	for (; count < option->most; count++) {
		ahead = rest;
		last = text_word(&ahead);
		if (option->numbers && !mtl_finite(last, &value[count]))
			break;
		rest = ahead;
	}
	map_option(map, word, value, option->numbers ? count : 0, last);
	*line = rest;
	return true;
}

/* Without a name a map is as good as none: some programs write so. */
static int mtl_map(struct mtl_map *map, struct text_span line, int number)
{
	struct text_span name;

	free(map->name);
	*map = (struct mtl_map){.line = number, .scale = {1, 1}, .strength = 1};
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
	return map->name ? 0 : -ENOMEM;
}

static bool any_above_0(struct text_span line)
{
	double value;

	for (struct text_span word = text_word(&line); !text_empty(word); word = text_word(&line))
		if (text_number(word, &value) && value > 0)
			return true;
	return false;
}

static int mtl_state(struct mtl *mtl, const struct mtl_statement *is, struct text_span word,
		     struct text_span line, const char *path, int number, struct fault *fault)
{
	float *at = (float *)(void *)((char *)mtl + is->at);
	struct text_span got;
	double value;

	switch (is->value) {
	case VALUE_COLOUR:
		return mtl_colour(mtl, at, word, line, path, number, fault);
	case VALUE_NUMBER:
		got = text_word(&line);
		if (text_is_any_case(got, "-halo"))
			got = text_word(&line);
		if (!mtl_finite(got, &value))
			return mtl_expect(path, number, word, "a number", got, fault);
		*at = fmaxf((float)value, 0);
		return 0;
	case VALUE_MAP:
		return mtl_map(&mtl->map[is->at], line, number) < 0
			       ? fault_say(fault, -ENOMEM, "%s: out of memory", path)
			       : 0;
	case VALUE_LEFT:
		mtl->left |= (unsigned)any_above_0(line) << is->at;
		return 0;
	case VALUE_LEFT_MAP:
		mtl->left |= (unsigned)!text_empty(text_name(line)) << is->at;
		return 0;
	}
	return 0;
}

/* ---- the library ---- */

static struct mtl *library_add(struct mtl_library *library, struct text_span name, const char *path,
			       bool blender)
{
	struct mtl *grown = realloc(library->materials,
				    ((size_t)library->count + 1) * sizeof(*grown)),
		   *mtl;

	if (!grown)
		return NULL;
	library->materials = grown;
	mtl = &grown[library->count];
	*mtl = (struct mtl){
		.name = text_copy(name),
		.by = strdup(path),
		.blender = blender,
		.kd = {UNSAID, UNSAID, UNSAID},
		.ks = {UNSAID, UNSAID, UNSAID},
		.ka = {UNSAID, UNSAID, UNSAID},
		.exponent = UNSAID,
		.coverage = UNSAID,
		.see_through = UNSAID,
		.roughness = UNSAID,
		.metalness = UNSAID,
		.illum = UNSAID,
	};
	library->count++;
	return mtl->name && mtl->by ? mtl : NULL;
}

static const struct mtl_statement *find_statement(struct text_span word)
{
	for (size_t k = 0; k < sizeof(statements) / sizeof(*statements); k++)
		if (text_is_any_case(word, statements[k].word))
			return &statements[k];
	return NULL;
}

static bool is_blenders(struct text_span comment)
{
	return comment.end - comment.at > 9 && !memcmp(comment.at, "# Blender", 9);
}

static int library_read(struct mtl_library *library, struct text_lines *lines, const char *path,
			struct fault *fault)
{
	struct mtl *mtl = NULL;
	struct text_span line;
	bool blender = false;
	int err = 0;

	while (!err && text_next_joined(lines, &line)) {
		const struct text_span whole = line;
		const struct text_span word = text_word(&line);
		const struct mtl_statement *is;

		blender |= is_blenders(whole);
		if (text_is_any_case(word, "newmtl")) {
			mtl = library_add(library, text_name(line), path, blender);
			if (!mtl)
				return fault_say(fault, -ENOMEM, "%s: out of memory", path);
			continue;
		}
		is = mtl ? find_statement(word) : NULL;
		if (is)
			err = mtl_state(mtl, is, word, line, path, lines->line, fault);
	}
	return err;
}

int mtl_read(struct mtl_library *library, const char *path, struct fault *fault)
{
	struct text_lines lines;
	struct plain_map file;
	int err = plain_file_map(&file, path, LIBRARY_MAX, fault);

	if (err)
		return err;
	text_begin(&lines, file.at, file.bytes);
	err = library_read(library, &lines, path, fault);
	text_end(&lines);
	plain_file_unmap(&file);
	return err;
}

int mtl_find(const struct mtl_library *library, struct text_span name)
{
	for (int k = 0; k < library->count; k++)
		if (text_is(name, library->materials[k].name))
			return k;
	for (int k = 0; k < library->count; k++)
		if (text_is_any_case(name, library->materials[k].name))
			return k;
	return -1;
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

/* Roughness by Ns: GGX of the same width as Phong's lobe has alpha^2 = 2 / (n + 2). */
static float mtl_roughness(const struct mtl *mtl)
{
	if (mtl->exponent < 0)
		return 0.5f;
	if (mtl->blender)
		return 1 - sqrtf(fminf(mtl->exponent, 1000) / 1000);
	return sqrtf(sqrtf(2 / (mtl->exponent + 2)));
}

/* As glTF: a metal's colour is its reflectance, and it has no base. */
static void set_metallic(struct material *m, float plastic, float metalness, float roughness)
{
	m->kind = MATERIAL_GLOSSY;
	m->roughness = within_1(roughness);
	m->metal = rgb_scale(m->colour, metalness);
	for (int c = 0; c < 3; c++)
		m->specular.c[c] = plastic * (1 - metalness) + m->metal.c[c];
	m->colour = rgb_scale(m->colour, 1 - metalness);
}

/* The sum of what base and mirror reflect is Kd + Ks, but at most 1. */
static void set_mirror(struct material *m, const float ks[3], float roughness)
{
	float most = 0;

	m->kind = MATERIAL_GLOSSY;
	m->roughness = within_1(roughness);
	for (int c = 0; c < 3; c++) {
		m->specular.c[c] = fminf(ks[c], 1 - m->colour.c[c]);
		most = fmaxf(most, m->specular.c[c]);
	}
	for (int c = 0; c < 3 && most < 1; c++)
		m->colour.c[c] = fminf(m->colour.c[c] / (1 - most), 1);
}

static void set_plastic(struct material *m, const float ks[3], float roughness)
{
	m->kind = MATERIAL_GLOSSY;
	m->roughness = within_1(roughness);
	for (int c = 0; c < 3; c++)
		m->specular.c[c] = PLASTIC * ks[c];
}

static bool has_pbr(const struct mtl *mtl)
{
	return mtl->roughness >= 0 || mtl->metalness >= 0 || mtl->map[MAP_ROUGHNESS].name ||
	       mtl->map[MAP_METALNESS].name;
}

static void set_surface(const struct mtl *mtl, struct material *m)
{
	const bool mirror = mtl->illum == 3 || mtl->illum == 8;
	const float plastic = PLASTIC * (mtl->ks[0] >= 0 ? mean_of(mtl->ks) : 0.5f);

	if (has_pbr(mtl))
		set_metallic(m, plastic, within_1(mtl->metalness),
			     mtl->roughness >= 0 ? mtl->roughness : mtl_roughness(mtl));
	else if (mtl->blender && (mirror || mtl->illum == 6) && mtl->ka[0] >= 0)
		set_metallic(m, plastic, mean_of(mtl->ka), mtl_roughness(mtl));
	else if (mean_of(mtl->ks) <= 0 || mtl->illum == 0 || mtl->illum == 1 || mtl->illum == 10)
		m->kind = MATERIAL_DIFFUSE;
	else if (mirror)
		set_mirror(m, mtl->ks, mtl_roughness(mtl));
	else
		set_plastic(m, mtl->ks, mtl_roughness(mtl));
}

static struct texture_name name_of(const struct mtl *mtl, enum mtl_map_kind kind)
{
	const struct mtl_map *map = &mtl->map[kind];

	return (struct texture_name){map->name ? mtl->by : NULL, map->line, map->name};
}

static enum texture_wrap wrap_of(const struct mtl_map *map)
{
	return map->clamp ? TEXTURE_CLAMP : TEXTURE_REPEAT;
}

static struct texture_use use_of(const struct mtl_map *map, const struct texture *texture)
{
	return (struct texture_use){
		.texture = texture,
		.place = {map->scale[0], 0, map->offset[0], 0, map->scale[1], map->offset[1]},
	};
}

static bool is_moved(const struct mtl_map *map)
{
	return map->scale[0] != 1 || map->scale[1] != 1 || map->offset[0] != 0 ||
	       map->offset[1] != 0;
}

static int add_colour(const struct mtl *mtl, struct textures *textures, struct material *m,
		      struct fault *fault)
{
	const struct texture_name colour = name_of(mtl, MAP_COLOUR),
				  cover = name_of(mtl, MAP_COVERAGE);
	const struct mtl_map *map = &mtl->map[colour.by ? MAP_COLOUR : MAP_COVERAGE];
	int err;

	if (!colour.by && !cover.by)
		return 0;
	err = textures_colour(textures, &colour, &cover, wrap_of(map), &m->texture, fault);
	if (err)
		return err;
	if (is_moved(map))
		m->placed = use_of(map, m->texture);
	if (cover.by)
		m->alpha_mode = ALPHA_BLEND;
	return 0;
}

/* Roughness and metalness of a texture. The values of the material become its means. */
static int add_surface(const struct mtl *mtl, struct textures *textures, struct material *m,
		       struct fault *fault)
{
	const struct texture_name rough = name_of(mtl, MAP_ROUGHNESS),
				  metal = name_of(mtl, MAP_METALNESS);
	const struct mtl_map *map = &mtl->map[rough.by ? MAP_ROUGHNESS : MAP_METALNESS];
	const float plastic = PLASTIC * (mtl->ks[0] >= 0 ? mean_of(mtl->ks) : 0.5f);
	const struct texture *texture;
	double sum[2] = {0, 0};
	size_t pixels;
	int err;

	if (!rough.by && !metal.by)
		return 0;
	err = textures_surface(textures, &rough, &metal, wrap_of(map), &texture, fault);
	if (err)
		return err;
	m->map = (struct surface_map){
		.use = use_of(map, texture),
		.base = rgb_make(mtl->kd[0], mtl->kd[1], mtl->kd[2]),
		.specular = rgb_make(plastic, plastic, plastic),
		.metallic = metal.by ? 1 : within_1(mtl->metalness),
		.roughness = rough.by		   ? 1
			     : mtl->roughness >= 0 ? within_1(mtl->roughness)
						   : mtl_roughness(mtl),
	};
	if (mtl->kd[0] < 0)
		m->map.base = rgb_make(1, 1, 1);
	pixels = (size_t)texture->image.width * (size_t)texture->image.height;
	for (size_t k = 0; k < pixels; k++)
		for (int c = 0; c < 2; c++)
			sum[c] += texture->image.u8[3 * k + 1 + (size_t)c] / 255.0;
	m->colour = m->map.base;
	set_metallic(m, plastic, m->map.metallic * (float)(sum[1] / (double)pixels),
		     m->map.roughness * (float)(sum[0] / (double)pixels));
	return 0;
}

/* Many programs, Blender among them, write maps of normals as bump maps. Heights of the format have no
 * unit, so they are left out, as is a bump map that is missing. */
static int add_normals(const struct mtl *mtl, struct textures *textures, struct material *m,
		       unsigned *left, struct fault *fault)
{
	const bool heights = !mtl->map[MAP_NORMALS].name;
	const struct mtl_map *map = &mtl->map[heights ? MAP_BUMPS : MAP_NORMALS];
	const struct texture_name name = name_of(mtl, heights ? MAP_BUMPS : MAP_NORMALS);
	const struct texture *texture;
	int err;

	if (!name.by)
		return 0;
	err = textures_data(textures, &name, wrap_of(map), &texture, fault);
	if (heights && (err || !texture_has_normals(texture))) {
		*left |= 1u << LEFT_BUMPS;
		return err == -ENOMEM ? err : 0;
	}
	if (err)
		return err;
	m->bumps = use_of(map, texture);
	m->bump_scale = map->strength;
	return 0;
}

int mtl_make(const struct mtl_library *library, int number, struct textures *textures,
	     struct material *m, struct left_out *out, struct fault *fault)
{
	const struct mtl *mtl = &library->materials[number];
	unsigned left = mtl->left;
	int err;

	*m = (struct material){.ior = 1.5f, .alpha = 1, .colour = {{0.8f, 0.8f, 0.8f}}};
	if (mtl->kd[0] >= 0)
		m->colour = rgb_make(mtl->kd[0], mtl->kd[1], mtl->kd[2]);
	else if (mtl->map[MAP_COLOUR].name)
		m->colour = rgb_make(1, 1, 1);
	set_surface(mtl, m);
	if (mtl->coverage >= 0 || mtl->see_through >= 0)
		m->alpha = within_1(mtl->coverage >= 0 ? mtl->coverage : 1 - mtl->see_through);
	if (m->alpha < 1)
		m->alpha_mode = ALPHA_BLEND;
	err = add_colour(mtl, textures, m, fault);
	if (!err)
		err = add_surface(mtl, textures, m, fault);
	if (!err)
		err = add_normals(mtl, textures, m, &left, fault);
	if (err)
		return err;
	if (m->alpha_mode == ALPHA_OPAQUE && m->texture && m->texture->image.alpha)
		left |= 1u << LEFT_ALPHA;
	if (mtl->map[MAP_COLOUR].name)
		left &= ~(1u << LEFT_AMBIENT); /* most have the same map for both */
	if (m->alpha <= 0)
		log_warning_once("%s: material %s is wholly transparent, as d or Tr says", mtl->by,
				 mtl->name);
	if (mtl->illum == 10)
		left |= 1u << LEFT_CATCHER;
	if (m->alpha < 1 && !mtl->blender &&
	    (mtl->illum == 4 || mtl->illum == 6 || mtl->illum == 7 || mtl->illum == 9))
		left |= 1u << LEFT_REFRACTION;
	for (size_t k = 0; k < sizeof(left_words) / sizeof(*left_words); k++)
		if (left & 1u << k)
			left_out_add(out, left_words[k], "material");
	return 0;
}
