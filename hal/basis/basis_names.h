/* SPDX-License-Identifier: MIT */
/* Names of poses: the rule that writer and reader share. Private to hal/basis. */
#ifndef INLAY_HAL_BASIS_BASIS_NAMES_H
#define INLAY_HAL_BASIS_BASIS_NAMES_H

#include <stdint.h>

#include "hal/basis/basis_format.h"

/* Returns 0 if these are valid names of a file's poses; -EINVAL, -ENOMEM. */
int basis_names_check(const struct basis_pose_name *names, uint32_t count);

#endif
