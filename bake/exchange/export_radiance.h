/* SPDX-License-Identifier: MIT */
/*
 * An export job for Radiance: the files of export_job.h, and
 *
 *     light000.rad     the cell of light 0 as distant suns of radiance 1, and so on
 *     materials.rad    for obj2mesh
 *     scene.rad        meshes and ground; ground.rad: without the objects
 *     object.rays      4 x 4 rays for each pixel, row by row, as rtrace -ff reads them (origin and
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

int export_radiance(const struct scene *scene, const struct dome *dome, const char *folder,
		    struct fault *fault);

#endif
