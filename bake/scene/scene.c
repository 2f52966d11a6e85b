/* SPDX-License-Identifier: MIT */
#include "bake/scene/scene.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

#include "bake/base/picture_file.h"
#include "bake/base/pixel_filter.h"
#include "bake/mesh/mesh_winding.h"
#include "bake/scene/keyframes.h"
#include "hal/base/input.h"
#include "hal/base/log.h"
#include "hal/optics/vec.h"

#define WIDTH 640
#define HEIGHT 480
#define GROUND_ALBEDO 0.5

/* ---- camera ---- */

static void *tsai_place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

static int read_camera(struct tsai_camera *camera, const char *path, struct fault *fault)
{
	static const struct ini_table tables[] = {
		{.section = "camera", .keys = tsai_keys, .place = tsai_place}, INI_TABLES_END};
	struct ini_report report = {.count = 0};
	struct fault why = {.text = ""};
	int err;

	*camera = (struct tsai_camera){.width = 0};
	ini_defaults(tsai_keys, camera);
	err = ini_read(path, tables, camera, &report);
	if (err) {
		*fault = report.first;
		return err;
	}
	if (!camera->width)
		return fault_say(fault, -EINVAL,
				 "%s: no section [camera], expected Tsai's constants", path);
	err = tsai_check(camera, &why);
	return err ? fault_say(fault, err, "%s: %s", path, why.text) : 0;
}

/* Changes the number of pixels of the same view. */
static void resize_camera(struct tsai_camera *camera, int width, int height)
{
	const double across = (double)width / camera->width, down = (double)height / camera->height;

	camera->pixel[0] /= across;
	camera->pixel[1] /= down;
	camera->centre_px[0] *= across;
	camera->centre_px[1] *= down;
	camera->edge_spread_px *= sqrt(across * down);
	camera->width = width;
	camera->height = height;
}

static int set_camera(struct scene *scene, int width, int height, struct fault *fault)
{
	const struct scene_file *file = scene->file;
	const struct scene_camera_values *c = &file->camera;
	struct tsai_camera *camera = &scene->camera;
	struct fault what = {.text = ""};
	double eye[3];
	int err;

	if (c->file[0]) {
		err = read_camera(camera, c->file, &what);
	} else if (file->tsai_given) {
		*camera = file->tsai;
		err = tsai_check(camera, &what);
	} else {
		if (!width)
			width = c->width ? c->width : WIDTH;
		if (!height)
			height = c->height ? c->height : HEIGHT;
		err = tsai_look_at(camera, width, height, c->position, c->look_at, c->field_deg,
				   &what);
		camera->edge_spread_px = c->edge_spread_px * width / (c->width ? c->width : WIDTH);
	}
	if (err)
		return fault_say(fault, err, "%s: %s", scene->path, what.text);
	if ((c->file[0] || file->tsai_given) && c->edge_spread_px > 0)
		camera->edge_spread_px = c->edge_spread_px;
	if (width || height)
		resize_camera(camera, width ? width : camera->width,
			      height ? height : camera->height);
	mat_apply_transposed(camera->rotation, camera->translation, eye);
	scene->eye = v3_make((float)-eye[0], (float)-eye[1], (float)-eye[2]);
	if (file->ground.given && scene->eye.z <= 0)
		return fault_say(fault, -EINVAL,
				 "%s: [camera] position: %g below the ground, expected Z above 0",
				 scene->path, (double)-scene->eye.z);
	return 0;
}

/* ---- materials and meshes ---- */

static struct rgb colour_of(const double c[3])
{
	return rgb_make((float)c[0], (float)c[1], (float)c[2]);
}

static int load_material(struct scene *scene, int k, struct fault *fault)
{
	const struct scene_material_values *from = &scene->file->material[k];
	struct fault what = {.text = ""};
	int err;

	scene->materials[k] = (struct material){
		.kind = (enum material_kind)from->kind,
		.colour = colour_of(from->colour),
		.specular = colour_of(from->specular),
		.roughness = (float)from->roughness,
		.ior = (float)from->ior,
		.thin = from->thin,
	};
	if (!from->texture[0])
		return 0;
	scene->textures[k] = calloc(1, sizeof(*scene->textures[k]));
	if (!scene->textures[k])
		return fault_say(fault, -ENOMEM, "%s: out of memory", scene->path);
	err = picture_file_read(from->texture, &scene->textures[k]->image, &what);
	if (!err && picture_file_decode(&scene->textures[k]->image, false) < 0)
		err = fault_say(&what, -ENOMEM, "out of memory");
	if (err)
		return fault_say(fault, err, "%s: [material %s] texture: %s", scene->path,
				 from->name, what.text);
	texture_prepare(scene->textures[k]);
	scene->materials[k].texture = scene->textures[k];
	return 0;
}

/* Warns of an open mesh of glass that bends light: light inside of it has no way out. */
static void warn_of_open_glass(const struct mesh *mesh, const struct material *material,
			       const char *path)
{
	bool bends = false;

	for (int k = 0; k < mesh->part_count && !bends; k++) {
		const struct material *m = material ? material
					   : mesh->parts[k].material < mesh->material_count
						   ? &mesh->materials[mesh->parts[k].material]
						   : NULL;

		bends = m && m->kind == MATERIAL_GLASS && !m->thin && m->ior != 1;
	}
	if (bends && !mesh_is_closed(mesh->parts, mesh->part_count))
		log_warning_once(
			"%s: glass that is not closed: light enters and never leaves; thin = yes is meant?",
			path);
}

static int load_mesh(struct scene *scene, int k, struct fault *fault)
{
	const struct scene_mesh_values values = keyframe_mesh(scene->file, k, scene->pose);
	const struct scene_mesh_values *from = &values;
	const struct scene_keyframe_values *frame = keyframe_of_file(scene->file, k, scene->pose);
	const char *section = frame ? "keyframe" : from->standin ? "standin" : "object";
	const struct scene_material_values *named =
		from->material[0] ? scene_file_material(scene->file, from->material) : NULL;
	const struct material *material = named ? &scene->materials[named - scene->file->material]
						: NULL;
	struct mesh_placement placement = {
		.scale = from->scale,
		.crease_deg = from->crease_deg,
		.y_up = from->up == 0,
		.stand = from->stand,
		.own_materials = !material,
	};
	struct fault what = {.text = ""};
	int err;

	memcpy(placement.rotate_deg, from->rotate_deg, sizeof(placement.rotate_deg));
	memcpy(placement.position, from->position, sizeof(placement.position));
	err = mesh_read(&scene->meshes[k], from->file, &placement, &what);
	if (!err)
		warn_of_open_glass(&scene->meshes[k], material, from->file);
	if (!err)
		err = world_add(scene->world, &scene->meshes[k], material,
				from->standin ? SURFACE_STANDIN : SURFACE_OBJECT, &what);
	if (err)
		return fault_say(fault, err, "%s: [%s %s] file: %s", scene->path, section,
				 frame ? frame->name : from->name, what.text);
	return 0;
}

static void set_ground(struct scene *scene)
{
	const struct scene_ground_values *from = &scene->file->ground;
	const struct scene_material_values *named =
		from->material[0] ? scene_file_material(scene->file, from->material) : NULL;
	const struct material grey = {
		.kind = MATERIAL_DIFFUSE,
		.colour = {{GROUND_ALBEDO, GROUND_ALBEDO, GROUND_ALBEDO}},
	};

	if (!from->given)
		return;
	for (int c = 0; c < 3; c++)
		scene->ground_albedo[c] = named ? named->colour[c] : GROUND_ALBEDO;
	world_ground(scene->world, named ? &scene->materials[named - scene->file->material] : &grey,
		     from->extent);
}

/* Adds a file's bytes to the hash. A file that cannot be read is reported when its pose is
 * loaded. */
static void hash_file(const char *path, XXH3_state_t *state)
{
	FILE *stream;
	char part[1 << 14];
	size_t bytes;

	(void)input_stream(path, &stream, NULL);
	while (stream && (bytes = fread(part, 1, sizeof(part), stream)) > 0)
		XXH3_64bits_update(state, part, bytes);
	if (stream)
		fclose(stream);
}

/* Adds the values by which poses differ, if there are several poses. */
static void hash_poses(const struct scene_file *file, XXH3_state_t *state)
{
	for (int p = 0; p < file->poses.count && file->poses.count > 1; p++) {
		const char *name = keyframe_pose_name(file, p);

		XXH3_64bits_update(state, name, strlen(name) + 1);
		for (int k = 0; k < file->mesh_count; k++) {
			const struct scene_mesh_values m = keyframe_mesh(file, k, p);

			XXH3_64bits_update(state, &m.scale, sizeof(m.scale));
			XXH3_64bits_update(state, m.rotate_deg, sizeof(m.rotate_deg));
			XXH3_64bits_update(state, m.position, sizeof(m.position));
		}
	}
	for (int k = 0; k < file->keyframe_count; k++)
		if (file->keyframe[k].file[0])
			hash_file(file->keyframe[k].file, state);
}

/* Hashes the contents of files, not their paths, so that a scene may move to another folder. */
static uint64_t hash_scene(const struct scene *scene)
{
	const struct scene_file *file = scene->file;
	XXH3_state_t *state = XXH3_createState();
	uint64_t hash;

	XXH3_64bits_reset(state);
	XXH3_64bits_update(state, &scene->camera,
			   tsai_is_plain(&scene->camera)
				   ? offsetof(struct tsai_camera, kappa2)
				   : offsetof(struct tsai_camera, edge_spread_px));
	if (scene->camera.edge_spread_px > 0)
		XXH3_64bits_update(state, &scene->camera.edge_spread_px,
				   sizeof(scene->camera.edge_spread_px));
	XXH3_64bits_update(state, &file->ground.given, sizeof(file->ground.given));
	XXH3_64bits_update(state, &file->ground.extent, sizeof(file->ground.extent));
	for (int k = 0; k < file->material_count; k++) {
		const struct scene_material_values *m = &file->material[k];
		const struct texture *texture = scene->textures[k];

		XXH3_64bits_update(state, m->name, strlen(m->name));
		XXH3_64bits_update(state, &m->kind, sizeof(m->kind));
		XXH3_64bits_update(state, m->colour, sizeof(m->colour));
		XXH3_64bits_update(state, m->specular, sizeof(m->specular));
		XXH3_64bits_update(state, &m->roughness, sizeof(m->roughness));
		XXH3_64bits_update(state, &m->ior, sizeof(m->ior));
		if (m->thin)
			XXH3_64bits_update(state, &m->thin, sizeof(m->thin));
		if (texture)
			texture_hash(texture, state);
	}
	XXH3_64bits_update(state, file->ground.material, strlen(file->ground.material));
	for (int k = 0; k < file->mesh_count; k++) {
		const uint64_t mesh = mesh_hash(&scene->meshes[k]);

		XXH3_64bits_update(state, &mesh, sizeof(mesh));
		XXH3_64bits_update(state, &file->mesh[k].standin, sizeof(file->mesh[k].standin));
		XXH3_64bits_update(state, file->mesh[k].material, strlen(file->mesh[k].material));
	}
	hash_poses(file, state);
	hash = XXH3_64bits_digest(state);
	XXH3_freeState(state);
	return hash;
}

/* Loads all meshes in scene->pose, and the ground. */
static int build_world(struct scene *scene, struct fault *fault)
{
	int err = world_create(&scene->world, fault);

	for (int k = 0; k < scene->file->mesh_count && !err; k++)
		err = load_mesh(scene, k, fault);
	if (err)
		return err;
	set_ground(scene);
	return world_commit(scene->world, fault);
}

static void free_world(struct scene *scene)
{
	world_destroy(scene->world);
	scene->world = NULL;
	for (int k = 0; k < SCENE_MESHES_MAX; k++)
		mesh_free(&scene->meshes[k]);
}

/* Reads the finer parts of the sky. A file's path starts at the scene's folder. */
static int load_fine(struct scene *scene, struct fault *fault)
{
	const char *text = scene->file->dome.fine, *slash = strrchr(scene->path, '/');
	char folder[INI_PATH_MAX], key[INI_PATH_MAX + 32];

	snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(slash - scene->path) : 0,
		 scene->path);
	snprintf(key, sizeof(key), "%s: [dome] fine", scene->path);
	return *text ? fine_list_read(&scene->fine, key, text, folder, fault) : 0;
}

int scene_open(struct scene **out, const char *path, int width, int height, struct fault *fault)
{
	struct scene *scene = calloc(1, sizeof(*scene));
	int err;

	if (!scene)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	snprintf(scene->path, sizeof(scene->path), "%s", path);
	scene->file = malloc(sizeof(*scene->file));
	if (!scene->file) {
		err = fault_say(fault, -ENOMEM, "%s: out of memory", path);
		goto close_scene;
	}
	err = scene_file_read(scene->file, path, fault);
	if (err)
		goto close_scene;
	err = set_camera(scene, width, height, fault);
	if (!err)
		err = load_fine(scene, fault);
	if (err)
		goto close_scene;
	for (int k = 0; k < scene->file->material_count && !err; k++)
		err = load_material(scene, k, fault);
	if (!err)
		err = build_world(scene, fault);
	if (err)
		goto close_scene;
	scene->hash = hash_scene(scene);
	*out = scene;
	return 0;
close_scene:
	scene_close(scene);
	return err;
}

int scene_take_pose(struct scene *scene, int pose, struct fault *fault)
{
	if (pose == scene->pose)
		return 0;
	free_world(scene);
	scene->pose = pose;
	return build_world(scene, fault);
}

int scene_find_pose(struct scene *scene, const char *pose, struct fault *fault)
{
	const int number = pose ? keyframe_find_pose(scene->file, pose, fault) : 0;

	return number < 0 ? number : scene_take_pose(scene, number, fault);
}

void scene_close(struct scene *scene)
{
	if (!scene)
		return;
	free_world(scene);
	for (int k = 0; k < SCENE_MATERIALS_MAX; k++)
		if (scene->textures[k]) {
			image_free(&scene->textures[k]->image);
			free(scene->textures[k]);
		}
	fine_list_free(&scene->fine);
	free(scene->file);
	free(scene);
}

bool scene_look(const struct scene *scene, enum presence presence, double x, double y,
		struct surface *surface, struct v3 *direction)
{
	const double px[2] = {x, y};
	double origin[3], d[3];

	if (tsai_ray(&scene->camera, px, origin, d) < 0)
		return false;
	*direction = v3_make((float)d[0], (float)d[1], (float)d[2]);
	return world_nearest(scene->world, presence, scene->eye, *direction, surface);
}

void scene_place(const struct scene *scene, int x, int y, const double unit[2], double place[2])
{
	const double sigma = scene->camera.edge_spread_px;

	place[0] = x + pixel_filter_place(sigma, unit[0]);
	place[1] = y + pixel_filter_place(sigma, unit[1]);
}

int scene_camera_text(const struct scene *scene, char *text, size_t room)
{
	size_t used = (size_t)snprintf(text, room, "[camera]\n");

	for (const struct ini_key *key = tsai_keys; key->name; key++) {
		char value[512];

		if (ini_left_out(key, &scene->camera))
			continue;
		ini_value_text(key, &scene->camera, value, sizeof(value));
		if (used < room)
			used += (size_t)snprintf(text + used, room - used, "%s = %s\n", key->name,
						 value);
	}
	return used < room ? 0 : -ENOSPC;
}

int scene_dome(const struct scene *scene, const struct scene_lights *lights, struct dome *dome,
	       struct fault *fault)
{
	const struct scene_dome_values *own = &scene->file->dome;
	const int frequency = lights->frequency < 0 ? own->frequency : lights->frequency;
	struct fine_list given = {.count = 0};
	int err = 0;

	if (lights->fine && *lights->fine)
		err = fine_list_read(&given, "--fine", lights->fine, NULL, fault);
	if (!err)
		err = fine_list_dome(lights->fine ? &given : &scene->fine, frequency, dome, fault);
	fine_list_free(&given);
	return err;
}
