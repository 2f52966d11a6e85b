/* SPDX-License-Identifier: MIT */
/*
 * Whether pictures of objects, pictures of the ground and coverage belong together. The edges of
 * the coverage must be edges of the pictures with objects, not of those without. A coverage that is
 * mirrored, upside down or inverted is told by its fitting better when that is undone.
 */
#ifndef INLAY_BAKE_EXCHANGE_IMPORT_FIT_H
#define INLAY_BAKE_EXCHANGE_IMPORT_FIT_H

#include "bake/exchange/import_pictures.h"

/* -EINVAL: object and ground are interchanged, or another coverage fits better; -ENOMEM. */
int import_fit_check(const struct import_pictures *pictures,
		     const struct import_pictures_settings *settings, struct fault *fault);

#endif
