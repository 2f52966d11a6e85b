/* SPDX-License-Identifier: MIT */
/* Numbered pictures: one for each light, named by a pattern such as o%03d.hdr. */
#ifndef INLAY_BAKE_EXCHANGE_PICTURES_H
#define INLAY_BAKE_EXCHANGE_PICTURES_H

#include <stddef.h>

#include "hal/base/fault.h"

/* Checks that the pattern has exactly one %d, perhaps with a width (%03d, %4d); else -EINVAL.
 * option: name of the option, for the fault. */
int picture_pattern_check(const char *pattern, const char *option, struct fault *fault);

/* Writes the name of a picture. The pattern must have been checked. -ENAMETOOLONG. */
int picture_name(const char *pattern, int number, char *name, size_t room);

#endif
