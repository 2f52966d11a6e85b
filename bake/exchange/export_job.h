/* SPDX-License-Identifier: MIT */
/*
 * A scene as another renderer takes it: a folder with the lights, the meshes and the textures,
 * which Radiance's and Blender's jobs have in common.
 *
 *     angles.txt       the lights, as inlay-bake import --angles reads them
 *     objects.obj      triangles in world coordinates, a normal and a texture coordinate at each
 *     standins.obj     corner, of material m0, m1 ...; absent where there are none
 *     texture0.hdr     of material m0, linear, multiplied by its colour
 *
 * Nothing in it names a place outside the folder.
 */
#ifndef INLAY_BAKE_EXCHANGE_EXPORT_JOB_H
#define INLAY_BAKE_EXCHANGE_EXPORT_JOB_H

#include <stdbool.h>

#include "bake/scene/scene.h"
#include "hal/base/output.h"
#include "hal/optics/dome.h"

/* How far the ground reaches that has no end: of the largest distance in the scene. */
#define EXPORT_REACH 1000.0

struct export_job {
	const struct scene *scene;
	const struct dome *dome;
	const char *folder;
	int digits; /* of a light's number in a picture's name */
	const struct material **material;
	int material_count;
	bool has_objects, has_standins;
	double span; /* what encloses meshes, camera and origin, from the origin */
};

/* Makes the folder, unless it is there, and writes into it what is listed above. -EINVAL: a scene
 * without ground or stand-ins, which no pictures of import can stand for; -ENOTEMPTY: a folder that
 * has files in it and none of an earlier export; -errno of the folder. */
int export_job_begin(struct export_job *job, const struct scene *scene, const struct dome *dome,
		     const char *folder, struct fault *fault);
void export_job_end(struct export_job *job); /* idempotent; zeroed is fine */

/* A file of the folder, to be committed. */
int export_job_open(const struct export_job *job, const char *name, struct output *out,
		    struct fault *fault);

/* From the origin: as far as the ground goes, or what stands in the scene where there is no ground.
 */
double export_job_reach(const struct export_job *job);

/* The command that takes the results, run in the folder: pictures end in this. */
void export_job_import(const struct export_job *job, const char *ending, char *text, size_t room);

#endif
