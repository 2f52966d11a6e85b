/* SPDX-License-Identifier: MIT */
/* Footprints of poses. Private to hal/basis. */
#ifndef INLAY_HAL_BASIS_BASIS_FOOT_H
#define INLAY_HAL_BASIS_BASIS_FOOT_H

#include <stdint.h>

#include "hal/basis/basis_format.h"

/* Checks footprints. 0; or -EINVAL, and *bad is the first that breaks a rule of README.md. */
int basis_foot_check(const struct basis_footprint *feet, uint32_t count, uint32_t *bad);

#endif
