/*
 * A camera as the program uses it: opened again when it was lost, its newest frame held until a
 * picture is made, decoded only then. What was decoded last stays, so that a lost camera leaves
 * its last picture.
 */
#ifndef INLAY_APP_SOURCE_H
#define INLAY_APP_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/camera.h"
#include "hal/frame.h"
#include "hal/image/image.h"
#include "hal/transfer.h"

struct source_settings {
	const char *name; /* as the configuration calls it; borrowed */
	const struct camera_ops *ops;
	struct camera_settings camera;
	void *options;		/* the driver's; borrowed */
	enum deinterlace deinterlace;
	enum transfer transfer; /* how linear radiance becomes 8-bit code values, where it must */
};

struct source {
	struct source_settings settings;
	struct camera camera;
	enum camera_situation said; /* the situation that was logged last */
	struct frame held;	    /* grabbed, not yet decoded; PIXEL_NONE: nothing */
	int64_t held_ns;	    /* when it was captured */
	int64_t heard_ns;	    /* when the camera last gave something, or was opened */
	uint64_t superseded;	    /* held frames for which a newer one came */
	uint64_t undecodable;
	uint64_t earlier_frames, earlier_lost, earlier_broken; /* of openings before this one */

	struct frame_decoder *decoder;
	struct transfer_tables *tables;
	struct canvas canvas; /* the last picture; width 0: there has been none */
	struct image linear;  /* the same before it was clipped, of a camera that gives RGBF */
	bool is_linear;
	int64_t picture_ns; /* when what is in canvas was captured */
};

int source_create(struct source *source, const struct source_settings *settings);
void source_destroy(struct source *source); /* idempotent; zeroed is fine */

/* Opens the camera. Only the caller knows what a failure means: source_complain() or the end. */
int source_open(struct source *source, struct fault *fault);

/* Logs a situation that differs from the one logged last. */
void source_complain(struct source *source, const struct fault *fault);

bool source_is_open(const struct source *source);

/* Whether waiting cannot mend it: a camera that is not one, a format that it does not have. */
bool source_is_hopeless(const struct source *source);

/* A descriptor to poll, -1 while there is nothing to wait for: a camera that makes frames on demand
 * is left alone while its last one is held. */
int source_descriptor(struct source *source);

/* Takes the newest frame, if there is one. A camera that is gone is closed, and said so once. */
void source_take(struct source *source, int64_t now_ns);

/* Once a second: names a camera that has fallen silent, closes it after a while. */
void source_watch(struct source *source, int64_t now_ns);

bool source_has_news(const struct source *source);
bool source_has_picture(const struct source *source);

/* Decodes what is held and gives the frame back. False: it did not decode; the picture before it
 * stays. */
bool source_decode(struct source *source);

/* Gives back what is held, undecoded. */
void source_drop(struct source *source);

struct source_counts {
	uint64_t frames, lost, broken; /* lost: also superseded; broken: also undecodable */
};

struct source_counts source_counts(const struct source *source);

#endif
