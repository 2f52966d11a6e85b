/* SPDX-License-Identifier: MIT */
/* A scene's meshes as Wavefront OBJ, and the materials that they are made of. */
#ifndef INLAY_BAKE_EXCHANGE_EXPORT_MESH_H
#define INLAY_BAKE_EXCHANGE_EXPORT_MESH_H

#include <stdbool.h>
#include <stdio.h>

#include "bake/exchange/export_job.h"

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
