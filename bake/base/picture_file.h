/* SPDX-License-Identifier: MIT */
/* Pictures of textures: all kinds that hal/image reads, with all 16 bits of PNG, and those of
 * programs for 3D objects: TIFF (BigTIFF too), BMP and TGA. */
#ifndef INLAY_BAKE_BASE_PICTURE_FILE_H
#define INLAY_BAKE_BASE_PICTURE_FILE_H

#include "hal/image/image.h"

/* As image_read_memory_deep(). The first picture of a TIFF counts; its floats are linear light,
 * also those of 16 bits. -EBADMSG also where a TIFF or TGA says that it is to be turned. */
int picture_file_read(const char *path, struct image *image, struct fault *fault);

/* Turns 16-bit code values, if the picture has them, into float ones: linear light of sRGB, or of
 * data the share of 65535. -ENOMEM. */
int picture_file_decode(struct image *image, bool data);

#endif
