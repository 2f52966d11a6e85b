/* SPDX-License-Identifier: MIT */
#include "bake/exchange/export_radiance.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "bake/exchange/export_job.h"
#include "bake/exchange/export_radiance.mk.h" /* by bake/module.mk */


/* Each further bounce costs Radiance as many rays as the one before; later ones change next to
 * nothing. */
#define BOUNCES_MAX 5

/* Ambient resolution in parts of the scene's span. Radiance's -ar counts parts of the whole ground,
 * so write_makefile() scales it. */
#define AMBIENT_PARTS 128

#define RAYS 4	/* RAYS x RAYS a pixel: steps of 1/16 at an edge */
#define SUNS 64 /* that make up a light */

/* ---- lights ---- */

enum { OBJECT_RAYS, SEEN_RAYS, GROUND_RAYS, RAY_FILES };

static const char *const names[RAY_FILES] = {"object.rays", "seen.rays", "ground.rays"};

#define RAY_FLOATS 6 /* origin, direction */

/* Whether a ray belongs into a file. */
static bool ray_belongs(const struct scene *scene, int file, double x, double y,
			struct v3 *direction)
{
	const enum presence presence = file == GROUND_RAYS ? WITHOUT_OBJECTS : WITH_OBJECTS;
	struct surface surface;

	return scene_look(scene, presence, x, y, &surface, direction) &&
	       (surface.kind == SURFACE_OBJECT) == (file == OBJECT_RAYS);
}

/* share: receives for each pixel the share of its rays that are in the file; or NULL. */
static int write_rays(const struct export_job *job, int file, int count, struct image *share,
		      struct fault *fault)
{
	const struct scene *scene = job->scene;
	const int width = scene->camera.width;
	const struct v3 eye = scene->eye;
	struct output out;
	int err = export_job_open(job, names[file], &out, fault);

	if (err)
		return err;
	for (int y = 0; y < count * scene->camera.height; y++)
		for (int x = 0; x < count * width; x++) {
			const double unit[2] = {(x % count + 0.5) / count,
						(y % count + 0.5) / count};
			float ray[RAY_FLOATS] = {0};
			double at[2];
			struct v3 d;

			scene_place(scene, x / count, y / count, unit, at);
			if (ray_belongs(scene, file, at[0], at[1], &d)) {
				const float there[RAY_FLOATS] = {eye.x, eye.y, eye.z,
								 d.x,	d.y,   d.z};

				memcpy(ray, there, sizeof(ray));
				for (int c = 0; share && c < 3; c++)
					share->f32[3 * (y / count * width + x / count) + c] +=
						1 / (float)(count * count);
			}
			fwrite(ray, sizeof(ray), 1, out.stream);
		}
	return output_commit(&out, fault);
}

static int write_coverage(const struct export_job *job, const struct image *share,
			  struct fault *fault)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/coverage.hdr", job->folder) >= (int)sizeof(path))
		return fault_say(fault, -ENAMETOOLONG, "%s: the name is too long", job->folder);
	return image_write(path, share, fault);
}

/* Writes object.rays, seen.rays and ground.rays with count x count rays a pixel, and coverage.hdr.
 */
static int export_rays(const struct export_job *job, int count, struct fault *fault)
{
	const struct tsai_camera *camera = &job->scene->camera;
	struct image share;
	int err = image_create_f32(&share, camera->width, camera->height);

	if (err)
		return fault_say(fault, err, "%s: out of memory", job->folder);
	for (int file = 0; !err && file < RAY_FILES; file++)
		err = write_rays(job, file, count, file == OBJECT_RAYS ? &share : NULL, fault);
	if (!err)
		err = write_coverage(job, &share, fault);
	image_free(&share);
	return err;
}

/* Radical inverse of k in base 2. */
static double radical_inverse(unsigned k)
{
	double value = 0, digit = 0.5;

	for (; k; k >>= 1, digit /= 2)
		value += k & 1 ? digit : 0;
	return value;
}

/*
 * Writes a light as suns at Hammersley's points, each with its share of the solid angle. Radiance
 * samples every sun by itself, so suns may overlap. It would sample a polygon as a square of the
 * same area, and lose what misses the polygon.
 */
static int write_rad_light(const struct export_job *job, int light, struct fault *fault)
{
	const double share = job->dome->solid_angle_sr[light] / SUNS;
	struct output out;
	char name[64];
	int err;

	snprintf(name, sizeof(name), "light%0*d.rad", job->digits, light);
	err = export_job_open(job, name, &out, fault);
	if (err)
		return err;
	fputs("void light cell 0 0 3 1 1 1\n", out.stream);
	for (int k = 0; k < SUNS; k++) {
		double d[3];

		dome_cell_sample(job->dome, light, (k + 0.5) / SUNS, radical_inverse((unsigned)k),
				 d);
		fprintf(out.stream, "cell source sun%d 0 0 4 %.9g %.9g %.9g %.9g\n", k, d[0], d[1],
			d[2], 2 * acos(1 - share / (2 * M_PI)) * (180 / M_PI));
	}
	return output_commit(&out, fault);
}

/* ---- materials and meshes ---- */

static bool is_black(const struct rgb *colour)
{
	return rgb_peak(*colour) <= 0;
}

static float rgb_mean(const struct rgb *colour)
{
	return (colour->c[0] + colour->c[1] + colour->c[2]) / 3;
}

/* Texture coordinates of Radiance's pictures run from 0 to 1 along the shorter side. */
static void write_rad_texture(FILE *to, const struct texture *texture, int number)
{
	const double width = texture->image.width << (texture->wrap[0] == TEXTURE_MIRROR);
	const double height = texture->image.height << (texture->wrap[1] == TEXTURE_MIRROR);
	const double across = fmax(width / height, 1), up = fmax(height / width, 1);

	fprintf(to,
		"void colorpict t%d 7 red green blue ./texture%d.hdr . %.9g*frac(Lu) %.9g*frac(Lv) 0 0\n",
		number, number, across, up);
}

static void write_rad_material(FILE *to, const struct material *m, int number)
{
	const struct rgb white = {{1, 1, 1}};
	const bool metal = m->kind == MATERIAL_GLOSSY && is_black(&m->colour);
	const struct rgb *colour = metal ? &m->specular : m->texture ? &white : &m->colour;
	const double specular = m->kind != MATERIAL_GLOSSY ? 0
				: metal			   ? 1
							   : (double)rgb_mean(&m->specular);
	const double roughness = m->kind == MATERIAL_GLOSSY ? (double)(m->roughness * m->roughness)
							    : 0;
	char modifier[32] = "void";

	if (m->kind == MATERIAL_GLASS && m->thin) {
		fprintf(to, "void glass m%d 0 0 4 %.9g %.9g %.9g %.9g\n", number,
			(double)m->colour.c[0], (double)m->colour.c[1], (double)m->colour.c[2],
			(double)m->ior);
		return;
	}
	if (m->kind == MATERIAL_GLASS) {
		fprintf(to, "void dielectric m%d 0 0 5 1 1 1 %.9g 0\n", number, (double)m->ior);
		return;
	}
	if (m->texture && !metal) {
		write_rad_texture(to, m->texture, number);
		snprintf(modifier, sizeof(modifier), "t%d", number);
	}
	fprintf(to, "%s %s m%d 0 0 5 %.9g %.9g %.9g %.9g %.9g\n", modifier,
		metal ? "metal" : "plastic", number, (double)colour->c[0], (double)colour->c[1],
		(double)colour->c[2], specular, roughness);
}

static int write_rad_materials(const struct export_job *job, struct fault *fault)
{
	struct output out;
	int err = export_job_open(job, "materials.rad", &out, fault);

	if (err)
		return err;
	for (int k = 0; k < job->material_count; k++)
		write_rad_material(out.stream, job->material[k], k);
	return output_commit(&out, fault);
}

static int write_world(const struct export_job *job, const char *name, bool objects,
		       struct fault *fault)
{
	const struct scene_ground_values *ground = &job->scene->file->ground;
	const double *a = job->scene->ground_albedo;
	struct output out;
	int err = export_job_open(job, name, &out, fault);

	if (err)
		return err;
	if (objects && job->has_objects)
		fputs("void mesh objects 1 ./objects.rtm 0 0\n", out.stream);
	if (job->has_standins)
		fputs("void mesh standins 1 ./standins.rtm 0 0\n", out.stream);
	if (ground->given)
		fprintf(out.stream,
			"void plastic ground 0 0 5 %.9g %.9g %.9g 0 0\n"
			"ground ring floor 0 0 8 0 0 0 0 0 1 0 %.9g\n",
			a[0], a[1], a[2], export_job_reach(job));
	return output_commit(&out, fault);
}

/* ---- notes ---- */

static void note_material(FILE *to, const struct material *m, int number)
{
	if (m->kind == MATERIAL_GLASS && !m->thin)
		fprintf(to,
			"m%d: glass is a dielectric without tint, and light does not reach through it straight from a cell\n",
			number);
	else if (m->kind == MATERIAL_GLOSSY)
		fprintf(to,
			"m%d: the coat is Ward's, not GGX, with one reflectance for all channels unless it is a metal%s\n",
			number, m->roughness < 0.1F ? "; a smooth one mirrors single suns" : "");
}

static int write_notes(const struct export_job *job, struct fault *fault)
{
	struct output out;
	int err = export_job_open(job, "notes.txt", &out, fault);

	if (err)
		return err;
	fputs("What Radiance does not take as the scene has it (m0, m1 ... as in materials.rad). Diffuse materials, textures and the camera's distortion are the same.\n",
	      out.stream);
	for (int k = 0; k < job->material_count; k++)
		note_material(out.stream, job->material[k], k);
	return output_commit(&out, fault);
}

/* ---- how to render it ---- */

static int write_makefile(const struct export_job *job, struct fault *fault)
{
	const struct tsai_camera *camera = &job->scene->camera;
	const char *standins = job->has_standins ? "standins.rtm" : "";
	const int bounces = job->scene->file->render.bounces;
	char command[512];
	struct output out;
	int err = export_job_open(job, "Makefile", &out, fault);

	if (err)
		return err;
	export_job_import(job, "hdr", command, sizeof(command));
	fprintf(out.stream, "WIDTH = %d\nHEIGHT = %d\nACROSS = %d\nDOWN = %d\n", camera->width,
		camera->height, RAYS * camera->width, RAYS * camera->height);
	fprintf(out.stream, "RESOLUTION = %.0f\n",
		ceil(AMBIENT_PARTS * fmax(export_job_reach(job) / job->span, 1)));
	fprintf(out.stream, "BOUNCES = %d\n", bounces < BOUNCES_MAX ? bounces : BOUNCES_MAX);
	fprintf(out.stream, "SCENE_MESHES = %s%s%s\nGROUND_MESHES = %s\n",
		job->has_objects ? "objects.rtm" : "",
		job->has_objects && job->has_standins ? " " : "", standins, standins);
	fputs("LIGHTS =", out.stream);
	for (int k = 0; k < job->dome->count; k++)
		fprintf(out.stream, " %0*d", job->digits, k);
	fprintf(out.stream, "\nIMPORT = %s\n", command);
	fputs(export_radiance_mk, out.stream);
	return output_commit(&out, fault);
}

int export_radiance(const struct scene *scene, const struct dome *dome, const char *folder,
		    struct fault *fault)
{
	struct export_job job;
	int err = export_job_begin(&job, scene, dome, folder, false, fault);

	if (err)
		return err;
	err = write_rad_materials(&job, fault);
	if (!err)
		err = write_world(&job, "scene.rad", true, fault);
	if (!err)
		err = write_world(&job, "ground.rad", false, fault);
	if (!err)
		err = write_notes(&job, fault);
	for (int i = 0; !err && i < dome->count; i++)
		err = write_rad_light(&job, i, fault);
	if (!err)
		err = export_rays(&job, RAYS, fault);
	if (!err)
		err = write_makefile(&job, fault);
	export_job_end(&job);
	return err;
}
