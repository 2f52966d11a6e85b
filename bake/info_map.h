/* SPDX-License-Identifier: MIT */
/* What each pixel of a basis file takes, as a picture. */
#ifndef INLAY_BAKE_INFO_MAP_H
#define INLAY_BAKE_INFO_MAP_H

#include "hal/base/fault.h"
#include "hal/basis/basis.h"

/*
 * Of the first pose's shown layer, three panels side by side, each of the basis's size (or a whole
 * multiple, where that would be too small to read), with a bar that says which colour is how much:
 * patterns of the blocks that hold a pixel, their columns, and their bytes shared out among their
 * pixels. Pixels that are not stored are grey. path ends in .png; -ENOMEM, or what writing it
 * failed with.
 */
int info_map_write(const struct basis *basis, const char *path, struct fault *fault);

#endif
