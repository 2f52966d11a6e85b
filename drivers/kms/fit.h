/* SPDX-License-Identifier: MIT */
/* Where a scaled picture stands on the screen. Pure: touches no device. */
#ifndef INLAY_DRIVERS_KMS_FIT_H
#define INLAY_DRIVERS_KMS_FIT_H

struct kms_box {
	int x, y, width, height; /* px of the screen */
};

/* The largest centred box on the screen for a picture whose pixels have height / width = squash. */
struct kms_box kms_fit_box(int width, int height, double squash, int screen_width,
			   int screen_height);

#endif
