/* SPDX-License-Identifier: MIT */
/* Between cairo's image surfaces and pictures, and the colours of maps. */
#ifndef INLAY_BAKE_BASE_SURFACE_H
#define INLAY_BAKE_BASE_SURFACE_H

#include <cairo.h>

#include "hal/image/image.h"

/* What a surface of CAIRO_FORMAT_RGB24 shows, as a new 8-bit picture. -ENOMEM. */
int surface_to_image(cairo_surface_t *surface, struct image *image);

/* A new surface of CAIRO_FORMAT_RGB24 that shows an 8-bit picture. NULL: no memory. */
cairo_surface_t *surface_of_image(const struct image *image);

/* From little (0) to much (1): ever lighter, from blue to yellow, so that it reads without its hues
 * too. */
void surface_ramp(double share, double rgb[3]);

/* The same as the stops of a gradient, for a map's bar. */
void surface_ramp_stops(cairo_pattern_t *gradient);

#endif
