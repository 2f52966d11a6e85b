/* SPDX-License-Identifier: MIT */
/*
 * Finds people between the camera and the ground of the object's surroundings, in the background's
 * picture. The empty place is linear in the light that is measured, so its picture is predicted for
 * the light of each frame; what differs from the prediction by more than the camera's noise is a
 * person, or a shadow that a person casts.
 *
 * For each frame call people_look(); then people_veil() is what the compositor needs. All calls
 * come from one thread. Nothing is allocated after people_create(). The same frames give the same
 * bytes, whatever the processor.
 */
#ifndef INLAY_HAL_PEOPLE_PEOPLE_H
#define INLAY_HAL_PEOPLE_PEOPLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/basis/basis_format.h"
#include "hal/colour/transfer.h"
#include "hal/compositor/live/veil.h"
#include "hal/frame/depth.h"
#include "hal/frame/view.h"
#include "hal/look/sensor_noise.h"
#include "hal/optics/dome.h"
#include "hal/optics/tsai.h"

struct people;

struct people_settings {
	int width, height;	     /* of the background's view, as the basis was baked */
	struct transfer_curve curve; /* transfer function of its code values */
	const struct dome *dome;     /* borrowed: of the lights that people_look() gets */
	/* Two texts that tell the camera and where it stands, read at creation alone; NULL: none.
	 * What was saved with others is of another place. */
	const char *camera, *calibration;
	/* Where a depth camera stands in the same world, of whose whole picture people_take_depth()
	 * gets the depths, read at creation alone. NULL: there is none, or it sees what the
	 * background sees. */
	const struct tsai_camera *depth_camera;
};

/* What the object touches, for one pose. Borrowed until the next call of people_place(). */
struct people_object {
	const uint16_t *coverage; /* [height][width], 65535 = 1 */
	/* [tiles], row by row: 1 where object, shadow or glass change the picture. People are
	 * looked for in these tiles and two around them. */
	const uint8_t *touched;
	/* [height][width]: 1, or 0 where nobody is looked for, as a screen or a mirror is there.
	 * NULL: 1 everywhere. */
	const uint8_t *shown;
	const struct tsai_camera *camera; /* NULL: not known, and nobody is in front */
	/* What the object covers of the ground. NULL: not known, the lower edge of the coverage
	 * stands in. */
	const struct basis_footprint *foot;
};

/* 0, or -ENOMEM, or -EINVAL: a side of the picture is below 8 pixels. */
int people_create(struct people **people, const struct people_settings *settings,
		  struct fault *fault);
void people_destroy(struct people *people); /* NULL is harmless */

/* Takes another object or pose. What was learned of the place stays. */
void people_place(struct people *people, const struct people_object *object);

/* Looks at a frame: background is the upright view, radiance[dome->count] the light at about the
 * same time, captured_ns when it was captured. */
void people_look(struct people *people, const struct picture *background,
		 const float (*radiance)[3], int64_t captured_ns);

/*
 * Gives the next look, and no other, the depths of about the same moment; borrowed until it
 * returns. Without settings.depth_camera the map shows what the background shows, as if from the
 * same place, in any number of pixels: a depth camera that is registered to the background's, or
 * one so close beside it that a person's inner parts coincide. Then a group's order is that of its
 * depths, and its feet's only where too few of them are known.
 */
void people_take_depth(struct people *people, const struct depth_map *depth);

/* What the last look saw, valid until the next call; NULL: nobody is there. */
const struct veil *people_veil(const struct people *people);

/* What is seen in the next frame is the empty place, everywhere. */
void people_learn(struct people *people);
/* Everything that was learned is forgotten. */
void people_forget(struct people *people);

/* The camera's noise, as measured in the frames that were looked at. */
const struct sensor_noise *people_noise(const struct people *people);

/* Below so much of people_report.sure nobody is in front but who moves. */
#define PEOPLE_SURE_LEAST 0.2

struct people_report {
	double learned; /* share of the looked-at place whose empty picture is known, 0..1 */
	int parts;	/* connected groups of people that the last look saw */
	int in_front;	/* of them in front of the object */
	double gain[3]; /* R, G, B: the camera's exposure against that of the learned place */
	double sure;	/* share of the place's texture that is seen where it was learned */
	/* By how many pixels, right and down, the picture has moved since the place was learned. */
	double moved_px[2];
	bool lost; /* by so many that nobody is looked for: the camera is to be calibrated */
};

struct people_report people_report(const struct people *people);

/*
 * What was learned, to be kept over a restart: people_saved_bytes() long, at most 20 MB; 0: the
 * picture is too large for that. people_save() copies the next part of it behind the first done
 * bytes, a short time's work, and returns how many are there then. Once all are, people_seal()
 * completes it, on any thread. people_forget() and people_restore() in between spoil it.
 *
 * people_restore() takes it, aligned as malloc() aligns: -EBADMSG if it is damaged, or of another
 * camera, size, light or transfer function, and nothing changes. The fault has no subject.
 */
size_t people_saved_bytes(const struct people *people);
size_t people_save(const struct people *people, void *to, size_t done);
void people_seal(void *saved, size_t bytes);
int people_restore(struct people *people, const void *from, size_t bytes, struct fault *fault);

#endif
