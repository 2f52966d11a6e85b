/* SPDX-License-Identifier: MIT */
/* The camera's rays for Radiance's rtrace, sorted by what they meet. */
#ifndef INLAY_BAKE_EXCHANGE_EXPORT_RAYS_H
#define INLAY_BAKE_EXCHANGE_EXPORT_RAYS_H

#include "bake/exchange/export_job.h"

/* Writes object.rays, seen.rays and ground.rays with count x count rays a pixel, and coverage.hdr.
 */
int export_rays(const struct export_job *job, int count, struct fault *fault);

#endif
