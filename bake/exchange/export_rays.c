/* SPDX-License-Identifier: MIT */
#include "bake/exchange/export_rays.h"

#include <errno.h>
#include <string.h>

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

int export_rays(const struct export_job *job, int count, struct fault *fault)
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
