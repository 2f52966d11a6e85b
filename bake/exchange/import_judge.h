/* SPDX-License-Identifier: MIT */
/* Checks whether imported pictures are what the options say: their roles, the ground, unit and
 * order. */
#ifndef INLAY_BAKE_EXCHANGE_IMPORT_JUDGE_H
#define INLAY_BAKE_EXCHANGE_IMPORT_JUDGE_H

#include "bake/exchange/import_pictures.h"

/*
 * Sets pictures->flat and pictures->ground. -EINVAL, and the fault says what to look at:
 *     - pictures of ground and objects are interchanged, or the coverage is inverted, as far as the
 *       ground gets brighter by it;
 *     - pictures of the objects alone show more than the objects;
 *     - flat ground does not have the light that cells of radiance 1 give;
 *     - pictures resemble those of distant lights more than those of neighbours.
 */
int import_judge(struct import_pictures *pictures, const struct import_pictures_settings *settings,
		 struct fault *fault);

#endif
