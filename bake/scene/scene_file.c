/* SPDX-License-Identifier: MIT */
#include "bake/scene/scene_file.h"

#include <errno.h>
#include <string.h>

#include "bake/mesh/material.h"
#include "bake/scene/keyframes.h"
#include "hal/optics/dome.h"

/* Coordinates are at most this, in world units: single precision resolves 0.06 there (2^-24). */
#define FAR 1e6

#define CAMERA(f) offsetof(struct scene_camera_values, f)
static const struct ini_key camera_keys[] = {
	{"file", INI_PATH, CAMERA(file), .fallback = "",
	 .help = "a calibrated camera: an INI file with Tsai's keys in its section [camera]; then no other key here is needed"},
	{"position", INI_REALS, CAMERA(position), 3, .min = -FAR, .max = FAR, .fallback = "0 0 0",
	 .unit = "world units", .help = "where the camera is"},
	{"look_at", INI_REALS, CAMERA(look_at), 3, .min = -FAR, .max = FAR, .fallback = "0 0 0",
	 .unit = "world units", .help = "the point in the middle of the picture"},
	{"field_deg", INI_REAL, CAMERA(field_deg), .min = 0.01, .max = 175, .fallback = "45",
	 .unit = "deg", .help = "horizontal field of view"},
	{"edge_spread", INI_REAL, CAMERA(edge_spread_px), .max = TSAI_EDGE_SPREAD_MAX,
	 .fallback = "0", .unit = "px",
	 .help = "sigma of the Gaussian by which the camera blurs edges; 0: what its file says"},
	{"width", INI_INT, CAMERA(width), .max = 16384, .fallback = "0", .unit = "px",
	 .help = "width of the picture; 0: 640"},
	{"height", INI_INT, CAMERA(height), .max = 16384, .fallback = "0", .unit = "px",
	 .help = "height of the picture; 0: 480"},
	INI_KEYS_END,
};

#define DOME(f) offsetof(struct scene_dome_values, f)
static const struct ini_key dome_keys[] = {
	{"frequency", INI_INT, DOME(frequency), .min = 1, .max = DOME_FREQUENCY_MAX,
	 .fallback = "9", .help = "of the geodesic dome: 9 makes 406 lights"},
	{"fine", INI_TEXT, DOME(fine), .fallback = "",
	 .help = "where lights are finer, as there are lamps, windows or the sun: \"azimuth height "
		 "radius frequency\", in degrees (azimuth from +X towards +Y), several separated by commas; or a file of such lines, as inlay-bake sky writes it"},
	INI_KEYS_END,
};

#define RENDER(f) offsetof(struct scene_render_values, f)
static const struct ini_key render_keys[] = {
	{"samples", INI_INT, RENDER(samples), .min = 1, .max = 65536, .fallback = "16",
	 .help = "camera rays a pixel"},
	{"noise", INI_REAL, RENDER(noise_levels), .max = 255, .fallback = "0",
	 .unit = "8-bit levels",
	 .help = "when above 0: as many rays as it takes to bring the estimated standard error below this"},
	{"bounces", INI_INT, RENDER(bounces), .max = 64, .fallback = "32",
	 .help = "surfaces after the first that light may come over; 0: direct light alone"},
	{"seed", INI_INT, RENDER(seed), .max = 2147483647, .fallback = "1",
	 .help = "of all random numbers: the same seed gives the same file"},
	{"error", INI_REAL, RENDER(error_rms), .min = 1e-3, .max = 255, .fallback = "0.6",
	 .unit = "8-bit levels, RMS",
	 .help = "what the encoding may be off by under a sky, in each tile; the file declares what it is"},
	{"error_max", INI_REAL, RENDER(error_max), .max = 255, .fallback = "0",
	 .unit = "8-bit levels", .help = "the same of any pixel; 0: twice error"},
	{"cell_error", INI_REAL, RENDER(error_cell), .min = 1e-3, .max = 255, .fallback = "1.4",
	 .unit = "8-bit levels",
	 .help = "what any pixel may be off by where a single cell gives all light"},
	{"column_cut", INI_REAL, RENDER(column_cut), .min = -1, .max = 0.1, .fallback = "-1",
	 .unit = "linear light, white is 1",
	 .help = "what a single light's own correction may change and yet be left out of a frame; below 0: 0.001, and less of more lights than 406, by the root of their number"},
	{"coarse", INI_INT, RENDER(coarse), .max = DOME_FREQUENCY_MAX, .fallback = "0",
	 .help = "frequency of the dome over which smooth light is gathered, at most that of [dome]; 0: 9 at most"},
	{"exact", INI_BOOL, RENDER(exact), .fallback = "no",
	 .help = "store every light in 16 bits as well, for the exact mode"},
	{"cache", INI_BOOL, RENDER(cache), .fallback = "yes",
	 .help = "take light that met several surfaces from a cache of points, traced once a pose: less time and noise for a small error; no: follow every path to its end"},
	INI_KEYS_END,
};

#define GROUND(f) offsetof(struct scene_ground_values, f)
static const struct ini_key ground_keys[] = {
	{"material", INI_TEXT, GROUND(material), .fallback = "",
	 .help = "diffuse or, of a polished floor, glossy, without texture; empty: grey that reflects one half"},
	{"extent", INI_REAL, GROUND(extent), .max = FAR, .fallback = "0", .unit = "world units",
	 .help = "radius of the ground around the origin; 0: without end"},
	INI_KEYS_END,
};

static const char *const up_names[] = {"y", "z", NULL};

#define MESH(f) offsetof(struct scene_mesh_values, f)
static const struct ini_key mesh_keys[] = {
	{"file", INI_PATH, MESH(file), .help = "OBJ, PLY or glTF"},
	{"material", INI_TEXT, MESH(material), .fallback = "",
	 .help = "name of a [material] section; empty: what the file itself says"},
	{"scale", INI_REAL, MESH(scale), .min = 1e-6, .max = 1e6, .fallback = "1",
	 .help = "world units in one unit of the file"},
	{"up", INI_CHOICE, MESH(up), .choices = up_names, .fallback = "y",
	 .help = "the file's axis that points up; y: the file's -Z then looks along world +Y"},
	{"rotate", INI_REALS, MESH(rotate_deg), 3, .min = -360, .max = 360, .fallback = "0 0 0",
	 .unit = "deg",
	 .help = "about world X, then Y, then Z, counter-clockwise seen from the axis's tip"},
	{"position", INI_REALS, MESH(position), 3, .min = -SCENE_MESH_FAR, .max = SCENE_MESH_FAR,
	 .fallback = "0 0 0", .unit = "world units", .help = "where the file's origin goes"},
	{"stand", INI_BOOL, MESH(stand), .fallback = "no",
	 .help = "move it up or down at last, so that its lowest point touches the ground"},
	{"crease_deg", INI_REAL, MESH(crease_deg), .max = 180, .fallback = "60", .unit = "deg",
	 .help = "edges sharper than this stay sharp where the file has no normals"},
	INI_KEYS_END,
};

#define MATERIAL(f) offsetof(struct scene_material_values, f)
static const struct ini_key material_keys[] = {
	{"kind", INI_CHOICE, MATERIAL(kind), .choices = material_kind_names, .fallback = "diffuse",
	 .help = "how it scatters light"},
	{"colour", INI_REALS, MATERIAL(colour), 3, .max = 1, .fallback = "0.8 0.8 0.8",
	 .unit = "r g b, linear",
	 .help = "what it reflects; of glass, what it lets through each surface"},
	{"texture", INI_PATH, MATERIAL(texture), .fallback = "",
	 .help = "a picture that multiplies colour, by the mesh's texture coordinates"},
	{"specular", INI_REALS, MATERIAL(specular), 3, .max = 1, .fallback = "0.04 0.04 0.04",
	 .unit = "r g b, linear",
	 .help = "of glossy: what the coat mirrors at normal incidence; 0.04 is varnish, 0.5 and more is metal"},
	{"roughness", INI_REAL, MATERIAL(roughness), .max = 1, .fallback = "0.3",
	 .help = "of glossy: 0 is a mirror, 1 is dull"},
	{"ior", INI_REAL, MATERIAL(ior), .min = 1, .max = 4, .fallback = "1.5",
	 .help = "of glass: index of refraction; 1 lets light through straight"},
	{"thin", INI_BOOL, MATERIAL(thin), .fallback = "no",
	 .help = "of glass: its surface stands for a whole pane, and what passes goes straight on"},
	INI_KEYS_END,
};

/* ---- where sections go ---- */

static void *scene_place_camera(void *root, const char *instance)
{
	(void)instance;
	return &((struct scene_file *)root)->camera;
}

static void *scene_place_tsai(void *root, const char *instance)
{
	struct scene_file *file = root;

	(void)instance;
	file->tsai_given = true;
	return &file->tsai;
}

static void *scene_place_dome(void *root, const char *instance)
{
	(void)instance;
	return &((struct scene_file *)root)->dome;
}

static void *scene_place_render(void *root, const char *instance)
{
	(void)instance;
	return &((struct scene_file *)root)->render;
}

static void *scene_place_ground(void *root, const char *instance)
{
	struct scene_file *file = root;

	(void)instance;
	file->ground.given = true;
	return &file->ground;
}

static void *scene_place_mesh(struct scene_file *file, const char *instance, bool standin)
{
	struct scene_mesh_values *mesh;

	for (int k = 0; k < file->mesh_count; k++)
		if (file->mesh[k].standin == standin && !strcmp(file->mesh[k].name, instance))
			return &file->mesh[k];
	if (file->mesh_count == SCENE_MESHES_MAX || strlen(instance) >= SCENE_NAME_MAX)
		return NULL;
	mesh = &file->mesh[file->mesh_count++];
	strcpy(mesh->name, instance);
	mesh->standin = standin;
	ini_defaults(mesh_keys, mesh);
	return mesh;
}

static void *scene_place_object(void *root, const char *instance)
{
	return scene_place_mesh(root, instance, false);
}

static void *scene_place_standin(void *root, const char *instance)
{
	return scene_place_mesh(root, instance, true);
}

static void *scene_place_poses(void *root, const char *instance)
{
	(void)instance;
	return &((struct scene_file *)root)->poses;
}

static void *scene_place_keyframe(void *root, const char *instance)
{
	return keyframe_place(root, instance);
}

static void *scene_place_material(void *root, const char *instance)
{
	struct scene_file *file = root;
	struct scene_material_values *material;

	for (int k = 0; k < file->material_count; k++)
		if (!strcmp(file->material[k].name, instance))
			return &file->material[k];
	if (file->material_count == SCENE_MATERIALS_MAX || strlen(instance) >= SCENE_NAME_MAX)
		return NULL;
	material = &file->material[file->material_count++];
	strcpy(material->name, instance);
	ini_defaults(material_keys, material);
	return material;
}

#define TABLE(name, is_named, list, placer, text)                                                  \
	{                                                                                          \
		.section = name, .named = is_named, .keys = list, .help = text, .place = placer    \
	}

static const struct ini_table scene_tables[] = {
	TABLE("camera", false, camera_keys, scene_place_camera, "from where the picture is taken"),
	TABLE("tsai", false, tsai_keys, scene_place_tsai,
	      "the same by Tsai's constants, instead of [camera]"),
	TABLE("dome", false, dome_keys, scene_place_dome, "the lights"),
	TABLE("render", false, render_keys, scene_place_render, "how well it is baked"),
	TABLE("ground", false, ground_keys, scene_place_ground,
	      "the real ground, the plane Z = 0: catches shadows; leave the section out for none"),
	TABLE("object", true, mesh_keys, scene_place_object, "a virtual object; one section each"),
	TABLE("standin", true, mesh_keys, scene_place_standin,
	      "stands for a real surface: catches shadows, hides objects behind it"),
	TABLE("poses", false, keyframe_poses_keys, scene_place_poses,
	      "positions, turns, animation"),
	TABLE("keyframe", true, keyframe_keys, scene_place_keyframe,
	      "what an object is like in one pose; poses between two keyframes lie between them"),
	TABLE("material", true, material_keys, scene_place_material,
	      "by the name that objects use"),
	INI_TABLES_END,
};

/* ---- checks that a table of keys cannot express ---- */

const struct scene_material_values *scene_file_material(const struct scene_file *file,
							const char *name)
{
	for (int k = 0; k < file->material_count; k++)
		if (!strcmp(file->material[k].name, name))
			return &file->material[k];
	return NULL;
}

static int check_material_name(const struct scene_file *file, const char *path, const char *section,
			       const char *name, struct fault *fault)
{
	const char *names[SCENE_MATERIALS_MAX], *nearest;

	if (!name[0] || scene_file_material(file, name))
		return 0;
	for (int k = 0; k < file->material_count; k++)
		names[k] = file->material[k].name;
	nearest = ini_nearest(name, names, (size_t)file->material_count);
	return fault_say(fault, -EINVAL,
			 "%s: [%s] material: there is no section [material %s], expected %s%s",
			 path, section, name, nearest ? "perhaps " : "the name of one",
			 nearest ? nearest : "");
}

static int scene_check_camera(const struct scene_file *file, const char *path, struct fault *fault)
{
	const struct scene_camera_values *c = &file->camera;

	if (file->tsai_given && c->file[0])
		return fault_say(
			fault, -EINVAL,
			"%s: [camera] file: there is a section [tsai] as well, expected one of them",
			path);
	if (file->tsai_given || c->file[0])
		return 0;
	if (!memcmp(c->position, c->look_at, sizeof(c->position)))
		return fault_say(
			fault, -EINVAL,
			"%s: [camera] position: the same as look_at, expected two points, a file, or a section [tsai]",
			path);
	return 0;
}

static int scene_check_ground(const struct scene_file *file, const char *path, struct fault *fault)
{
	const struct scene_material_values *m;
	int err;

	if (!file->ground.given)
		return 0;
	err = check_material_name(file, path, "ground", file->ground.material, fault);
	if (err || !file->ground.material[0])
		return err;
	m = scene_file_material(file, file->ground.material);
	if (m->kind == MATERIAL_GLASS || m->texture[0])
		return fault_say(
			fault, -EINVAL,
			"%s: [ground] material: %s is %s, expected a diffuse or glossy material without texture",
			path, m->name, m->texture[0] ? "textured" : material_kind_names[m->kind]);
	for (int c = 0; c < 3; c++)
		if (m->colour[c] < 1e-3)
			return fault_say(
				fault, -EINVAL,
				"%s: [material %s] colour: %g, expected at least 0.001 in every channel, since [ground] uses it",
				path, m->name, m->colour[c]);
	return 0;
}

static int scene_check(struct scene_file *file, const char *path, struct fault *fault)
{
	int objects = 0, err;

	for (int k = 0; k < file->mesh_count; k++) {
		const struct scene_mesh_values *mesh = &file->mesh[k];
		char section[SCENE_NAME_MAX + 16];

		objects += !mesh->standin;
		snprintf(section, sizeof(section), "%s %s", mesh->standin ? "standin" : "object",
			 mesh->name);
		if (!mesh->file[0])
			return fault_say(fault, -EINVAL, "%s: [%s] file: empty, expected a mesh",
					 path, section);
		err = check_material_name(file, path, section, mesh->material, fault);
		if (err)
			return err;
	}
	if (!objects)
		return fault_say(fault, -EINVAL,
				 "%s: no section [object NAME], expected at least one", path);
	err = scene_check_camera(file, path, fault);
	if (!err)
		err = scene_check_ground(file, path, fault);
	return err ? err : keyframes_settle(file, path, fault);
}

/* ---- reading ---- */

static void set_defaults(struct scene_file *file)
{
	memset(file, 0, sizeof(*file));
	ini_defaults(camera_keys, &file->camera);
	ini_defaults(tsai_keys, &file->tsai);
	ini_defaults(dome_keys, &file->dome);
	ini_defaults(render_keys, &file->render);
	ini_defaults(ground_keys, &file->ground);
	ini_defaults(keyframe_poses_keys, &file->poses);
}

int scene_file_read(struct scene_file *file, const char *path, struct fault *fault)
{
	struct ini_report report = {.count = 0};
	int err;

	set_defaults(file);
	err = ini_read(path, scene_tables, file, &report);
	if (err) {
		if (fault)
			*fault = report.first;
		return err;
	}
	return scene_check(file, path, fault);
}

int scene_file_read_memory(struct scene_file *file, const char *text, size_t bytes,
			   const char *name, struct fault *fault)
{
	struct ini_report report = {.count = 0};
	int err;

	set_defaults(file);
	err = ini_read_memory(text, bytes, name, ".", scene_tables, file, &report);
	if (err) {
		if (fault)
			*fault = report.first;
		return err;
	}
	return scene_check(file, name, fault);
}

void scene_render_defaults(struct scene_render_values *values)
{
	ini_defaults(render_keys, values);
}

void scene_file_write_sample(FILE *stream)
{
	ini_write_sample(stream, scene_tables);
}
