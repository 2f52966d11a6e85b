/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <math.h>

static int clamp_length(double length, int most)
{
	return length < 1 ? 1 : length > most ? most : (int)lrint(length);
}

struct kms_box kms_fit_box(int width, int height, double squash, int screen_width,
			   int screen_height)
{
	const double tall = height * squash;
	const double factor = fmin(screen_width / (double)width, screen_height / tall);
	struct kms_box box = {
		.width = clamp_length(width * factor, screen_width),
		.height = clamp_length(tall * factor, screen_height),
	};

	box.x = (screen_width - box.width) / 2;
	box.y = (screen_height - box.height) / 2;
	return box;
}
