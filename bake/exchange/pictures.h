/* SPDX-License-Identifier: MIT */
/* Numbered pictures: one for each light, named by a pattern such as o%03d.hdr. */
#ifndef INLAY_BAKE_EXCHANGE_PICTURES_H
#define INLAY_BAKE_EXCHANGE_PICTURES_H

#include <stddef.h>

#include "hal/base/fault.h"

/* Takes an option (options.h): a pattern with exactly one %d, perhaps with a width (%03d, %4d);
 * else -EINVAL. */
int picture_pattern_take(void *pattern, const char *option, const char *text, struct fault *fault);

/* Writes the name of a picture. The pattern must have been checked. -ENAMETOOLONG. */
int picture_name(const char *pattern, int number, char *name, size_t room);

#endif
