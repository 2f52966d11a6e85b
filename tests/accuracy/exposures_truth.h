/* SPDX-License-Identifier: MIT */
/* Private to exposures*.c: the truth of a place (its light, without a camera) and what the object
 * looks like there. */
#ifndef INLAY_TESTS_ACCURACY_EXPOSURES_TRUTH_H
#define INLAY_TESTS_ACCURACY_EXPOSURES_TRUTH_H

#include <stdbool.h>
#include <stddef.h>

#include "app/pipeline/pipeline.h"
#include "bake/truth/truth.h"
#include "hal/measure/measure.h"

#define PICTURES 72 /* up to 48 to measure the delay, then some rounds of exposures */
#define RATE_HZ 25.0
#define CARD 0.5 /* its reflectance */
/* The part of the picture that the program is told is the card. */
#define CARD_PATCH                                                                                 \
	{                                                                                          \
		.x = 4, .y = 4, .width = 40, .height = 30, .reflectance = { CARD, CARD, CARD }     \
	}

struct exposures_place {
	const char *name, *file; /* HDR file; NULL: the room of the project */
	double exposure;	 /* exposure at which a white ground has a radiance of 0.6 */
	double step; /* ratio of an exposure to the next; the shortest just does not clip */
};

struct table {
	struct basis basis;
	struct scene *scene;
	const char *folder;
	bool quick;
	struct scope scope;
};

/* The light of a place and pictures of the object under it. */
struct exposures_truth {
	float (*lights)[3];
	double irradiance[3];
	double *composite,
		*traced; /* [height][width][3], code values; traced is NULL where it is not known */
	struct canvas card;
	struct image panorama;
};

/* Prints a message and ends the program. */
__attribute__((format(printf, 1, 2), noreturn)) void die(const char *format, ...);
void must(int err, const struct fault *fault);
void *room_for(size_t count, size_t bytes);

void irradiance_of(const struct dome *dome, const float (*radiance)[3], double rgb[3]);
struct picture whole(const struct canvas *canvas);
void choose(struct pipeline *pipeline); /* Uses all lights, without a threshold. */

/* Allocates the pictures; free_truth() frees them. */
void truth_create(struct exposures_truth *truth, const struct table *table, int lights);

/* Fills card and composite under known lights and irradiance. Leaves the lights in the pipeline. */
void truth_show(struct exposures_truth *truth, struct pipeline *pipeline);

/* Finds the lights when the last picture is taken, and what the object looks like under them. */
void find_truth(const struct table *table, const struct exposures_place *place,
		struct exposures_truth *truth);

/* Estimates the clipped light from the card, as the 8-bit background camera sees it. */
void look_at_card(struct pipeline *pipeline, const struct exposures_truth *truth);

void free_truth(struct exposures_truth *truth);

#endif
