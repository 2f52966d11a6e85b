/* SPDX-License-Identifier: MIT */
/*
 * An export job for Radiance: the files of export_job.h, and
 *
 *     light000.rad     the cell of light 0 as distant suns of radiance 1, and so on
 *     materials.rad    for obj2mesh
 *     scene.rad        meshes and ground; ground.rad: without the objects
 *     object.rays      K x K rays for each pixel, row by row, as rtrace -ff reads them (origin and
 *     seen.rays        direction, 4-byte floats of this machine). object: rays that meet an
 *     ground.rays      object; seen: a real surface; ground: a real surface without the objects.
 *                      Other rays are zero, which rtrace renders black: no picture shows the sky.
 *     coverage.hdr     the share of a pixel's rays that meet an object
 *     Makefile         renders everything; pictures that exist are kept
 *     notes.txt        what Radiance's materials cannot express
 *
 * Rays are the calibrated camera's own, with all its distortion.
 */
#ifndef INLAY_BAKE_EXCHANGE_EXPORT_RADIANCE_H
#define INLAY_BAKE_EXCHANGE_EXPORT_RADIANCE_H

#include "bake/exchange/export_job.h"

#define EXPORT_RAYS_MAX 32
#define EXPORT_SUNS_MAX 4096
#define EXPORT_RADIANCE_DEFAULTS                                                                   \
	{                                                                                          \
		.rays = 4, .suns = 64                                                              \
	}

struct export_radiance_settings {
	int rays; /* K: K x K rays a pixel */
	int suns; /* for each cell; their solid angles sum to the cell's */
};

int export_radiance(const struct scene *scene, const struct dome *dome, const char *folder,
		    const struct export_radiance_settings *settings, struct fault *fault);

#endif
