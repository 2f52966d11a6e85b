/* SPDX-License-Identifier: MIT */
/* Numbered pictures: one for each light, named by a pattern such as o%03d.hdr. */
#ifndef INLAY_BAKE_EXCHANGE_PICTURES_H
#define INLAY_BAKE_EXCHANGE_PICTURES_H

#include <stddef.h>

#include "hal/base/fault.h"

/* -EINVAL: the pattern has not exactly one %d, perhaps with a width (%03d, %4d). option is what the
 * fault calls it. */
int picture_pattern_check(const char *pattern, const char *option, struct fault *fault);

/* A checked pattern with its number. -ENAMETOOLONG. */
int picture_name(const char *pattern, int number, char *name, size_t room);

#endif
