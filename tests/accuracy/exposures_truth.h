/* SPDX-License-Identifier: MIT */
/* Private to exposures*.c: a place as it is, without a camera, and what the object looks like
 * there. */
#ifndef INLAY_TESTS_ACCURACY_EXPOSURES_TRUTH_H
#define INLAY_TESTS_ACCURACY_EXPOSURES_TRUTH_H

#include <stdbool.h>
#include <stddef.h>

#include "app/pipeline/pipeline.h"
#include "bake/truth/truth.h"
#include "hal/measure/error.h"

#define PICTURES 72 /* the delay takes up to 48 to measure; then some turns */
#define RATE_HZ 25.0
#define CARD 0.5 /* its reflectance */
/* Of the card, what the program is told of. */
#define CARD_PATCH                                                                                 \
	{                                                                                          \
		.x = 4, .y = 4, .width = 40, .height = 30, .reflectance = { CARD, CARD, CARD }     \
	}

struct place {
	const char *name, *file; /* no file: the project's room */
	double exposure;	 /* at which a white ground has a radiance of 0.6 */
	double step;		 /* from an exposure to the next; the last just does not clip */
};

struct table {
	struct basis basis;
	struct scene *scene;
	const char *folder;
	bool quick;
	struct scope scope;
};

/* A place as it is, without a camera. */
struct truth {
	float (*lights)[3];
	double irradiance[3];
	double *composite, *traced; /* [height][width][3], code values; traced: NULL, not known */
	struct canvas card;
	struct image panorama;
};

/* Ends the program. */
__attribute__((format(printf, 1, 2), noreturn)) void die(const char *format, ...);
void must(int err, const struct fault *fault);
void *room_for(size_t count, size_t bytes);

void irradiance_of(const struct dome *dome, const float (*radiance)[3], double rgb[3]);
struct picture whole(const struct canvas *canvas);
void choose(struct pipeline *pipeline); /* all lights */

/* Room for one; free_truth() frees it. */
void truth_create(struct truth *truth, const struct table *table, int lights);

/* Fills card and composite: lights and irradiance are known. The pipeline has those lights then. */
void truth_show(struct truth *truth, struct pipeline *pipeline);

/* The lights when the last picture is taken, and what the object looks like under them. */
void find_truth(const struct table *table, const struct place *place, struct truth *truth);

/* What is clipped is looked for on the card, as the background's camera of 8 bits sees it. */
void look_at_card(struct pipeline *pipeline, const struct truth *truth);

void free_truth(struct truth *truth);

#endif
