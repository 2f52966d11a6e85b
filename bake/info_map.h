/* SPDX-License-Identifier: MIT */
/* A map of what each pixel of a basis file costs, as a picture. */
#ifndef INLAY_BAKE_INFO_MAP_H
#define INLAY_BAKE_INFO_MAP_H

#include "hal/base/fault.h"
#include "hal/basis/basis.h"

/*
 * Writes three panels side by side for the shown layer of the first pose: patterns of the blocks
 * that hold a pixel, their columns, and their bytes divided among their pixels. Each panel has the
 * size of the basis, or a whole multiple where that is too small for its texts, and a colour bar
 * below. Pixels that are not stored are grey. path ends in .png. -ENOMEM, -EFBIG, or the error of
 * writing the file.
 */
int info_map_write(const struct basis *basis, const char *path, struct fault *fault);

#endif
