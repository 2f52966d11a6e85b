/* SPDX-License-Identifier: MIT */
/*
 * The light of the sky's pieces (sky_need.h) in pictures of a calibrated fisheye.
 *
 * One scene in several exposures is merged (hal/lights/exposures.h). Light that is clipped in all
 * of them is brighter than the picture says by an unknown factor: it counts as SKY_EYE_CLIPPED
 * times the white of the shortest one, as it is a lamp or the sun.
 */
#ifndef INLAY_BAKE_SKY_SKY_EYE_H
#define INLAY_BAKE_SKY_SKY_EYE_H

#include "bake/sky/sky_need.h"
#include "hal/colour/transfer.h"
#include "hal/image/image.h"
#include "hal/lights/exposures.h"
#include "hal/lights/sampler.h"
#include "hal/optics/fisheye.h"

#define SKY_EYE_CLIPPED 100
/* A sky darker than this share of white, of the longest exposure, is noise (sky_need_add()). */
#define SKY_EYE_DARK 0.01

struct sky_eye_settings {
	struct fisheye_settings lens;
	struct transfer_curve curve; /* of 8-bit pictures */
	/* Exposures of 8-bit pictures, at most EXPOSURES_MAX, the longest first: the light that
	 * each lets in as a share of the first one's. */
	double ratio[EXPOSURES_MAX];
	int exposures;
};

struct sky_eye;

/* Makes an eye for upright pictures of a size. 0; -EINVAL: lens or size; -ENOMEM. */
int sky_eye_create(struct sky_eye **eye, const struct dome *pieces,
		   const struct sky_eye_settings *settings, int width, int height,
		   struct fault *fault);
void sky_eye_destroy(struct sky_eye *eye); /* NULL is harmless */

/* Reads a picture of an exposure (0 if there is one): 8 bit or linear. -EINVAL: another size;
 * -ENOMEM. */
int sky_eye_read(struct sky_eye *eye, const struct image *picture, int exposure);

/* Adds the light that was read last, times scale, to irradiance[pieces]. */
void sky_eye_gather(const struct sky_eye *eye, const struct sky_need *need, double scale,
		    double *irradiance);

/* Reads an 8-bit picture as light_sampler_read() does, or a linear one, of which nothing is
 * clipped. clipped may be NULL. -EINVAL: another size; -ENOMEM. */
int sky_eye_sample(struct light_sampler *sampler, const struct image *image, float (*radiance)[3],
		   double *clipped);

/* The E below which a sky of 8-bit pictures is noise. */
double sky_eye_least(void);

/* Reads a lens file as `inlay-calibrate fisheye` writes it. Errors of ini_read(); -EINVAL: it has
 * no section [fisheye]. */
int sky_eye_lens(struct fisheye_settings *lens, const char *path, struct fault *fault);

/* Reads pictures of one scene, in the settings' order of exposures, or a linear one, and adds them
 * as a moment. Errors name the file. */
int sky_need_add_pictures(struct sky_need *need, const struct sky_eye_settings *settings,
			  char *const *path, struct fault *fault);

#endif
