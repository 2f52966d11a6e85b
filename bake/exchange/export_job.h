/* SPDX-License-Identifier: MIT */
/*
 * What Blender's and Radiance's export jobs have in common: a folder with lights, meshes and
 * textures.
 *
 *     angles.txt       the lights, as inlay-bake import --angles reads them
 *     objects.obj      triangles in world coordinates with normals and texture coordinates, of
 *     standins.obj     materials m0, m1 ...; absent where there are no such meshes
 *                      Blender's have colours behind positions, where a material has any
 *     texture0.hdr     of material m0, linear, multiplied by its colour; what is mirrored
 *                      beyond an edge is in it twice
 *
 * No file in it refers to a path outside the folder.
 */
#ifndef INLAY_BAKE_EXCHANGE_EXPORT_JOB_H
#define INLAY_BAKE_EXCHANGE_EXPORT_JOB_H

#include <stdbool.h>
#include <stdio.h>

#include "bake/scene/scene.h"
#include "hal/base/output.h"
#include "hal/optics/dome.h"

/* Radius of a ground without end, in units of the largest distance in the scene. */
#define EXPORT_REACH 1000.0

struct export_job {
	const struct scene *scene;
	const struct dome *dome;
	const char *folder;
	int digits; /* digits of a light's number in file names */
	const struct material **material;
	int material_count;
	bool has_objects, has_standins;
	bool for_blender; /* which takes colours of vertices and textures that do not repeat */
	double span;	  /* largest distance of a vertex or of the camera from the origin */
};

/* Creates the folder unless it exists, and writes the files listed above. scene, dome and folder
 * must outlive the job. -EINVAL: the scene has neither ground nor stand-ins, so that no picture of
 * import could show a real surface; -ENOTEMPTY: the folder holds files but no earlier export;
 * -ENOMEM; -errno of the folder. */
int export_job_begin(struct export_job *job, const struct scene *scene, const struct dome *dome,
		     const char *folder, bool for_blender, struct fault *fault);
void export_job_end(struct export_job *job); /* idempotent; zeroed is fine */

/* Opens a file of the folder. The caller commits it. */
int export_job_open(const struct export_job *job, const char *name, struct output *out,
		    struct fault *fault);

/* Radius of the ground, or of the scene where there is no ground. */
double export_job_reach(const struct export_job *job);

/* Writes the command that imports the pictures, to be run in the folder. ending: of the pictures'
 * names, without a dot. */
void export_job_import(const struct export_job *job, const char *ending, char *text, size_t room);

/* Fills job->material: the scene's own materials, then those of the meshes' files. -ENOMEM. */
int export_materials(struct export_job *job, struct fault *fault);

/* Writes all objects, or all stand-ins, as one OBJ file. The caller checks the stream for
 * errors. */
void export_meshes(const struct export_job *job, bool standins, FILE *to);

/* What vertices say about a material. */
struct export_use {
	bool colours; /* some have */
	bool beyond;  /* some are beyond the edges of its texture */
};

struct export_use export_use_of(const struct export_job *job, const struct material *material);

#endif
