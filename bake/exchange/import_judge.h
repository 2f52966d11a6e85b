/* SPDX-License-Identifier: MIT */
/* Whether pictures of lights are what they are said to be: which is which, which ground, which
 * unit, which order. */
#ifndef INLAY_BAKE_EXCHANGE_IMPORT_JUDGE_H
#define INLAY_BAKE_EXCHANGE_IMPORT_JUDGE_H

#include "bake/exchange/import_pictures.h"

/*
 * Sets flat and ground of pictures that are read. -EINVAL: ground and objects interchanged, or an
 * inverted coverage, as far as ground gets brighter by it; objects alone that are not; on flat
 * ground, light that is not what the dome's cells of radiance 1 give; pictures that are more alike
 * between lights far apart than between neighbours. The fault says what to look at.
 */
int import_judge(struct import_pictures *pictures, const struct import_pictures_settings *settings,
		 struct fault *fault);

#endif
