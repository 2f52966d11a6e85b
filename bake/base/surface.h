/* SPDX-License-Identifier: MIT */
/* Conversion between cairo's image surfaces and pictures. */
#ifndef INLAY_BAKE_BASE_SURFACE_H
#define INLAY_BAKE_BASE_SURFACE_H

#include <cairo.h>

#include "hal/image/image.h"

/* Copies a surface of CAIRO_FORMAT_RGB24 to a new 8-bit picture, which the caller frees.
 * -ENOMEM. */
int surface_to_image(cairo_surface_t *surface, struct image *image);

/* Copies an 8-bit picture to a new surface of CAIRO_FORMAT_RGB24, which the caller destroys. NULL:
 * out of memory. */
cairo_surface_t *surface_of_image(const struct image *image);

#endif
