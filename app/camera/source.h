/* SPDX-License-Identifier: MIT */
/*
 * A camera as the program uses it: opened on a thread of its own, again when it was lost, its
 * newest frame held until a picture is made.
 *
 * A raw frame then is the picture, read where the camera left it (hal/frame/frame_reader.h), and given
 * back only when the next one is to be had; whoever wants it whole has it converted then. Others
 * are decoded whole and given back. Either way the last picture stays when the camera is lost.
 */
#ifndef INLAY_APP_CAMERA_SOURCE_H
#define INLAY_APP_CAMERA_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "app/camera/opener.h"
#include "hal/colour/transfer.h"
#include "hal/device/camera.h"
#include "hal/frame/frame.h"
#include "hal/image/image.h"

struct source_settings {
	const char *name; /* as the configuration calls it; borrowed */
	const struct camera_ops *ops;
	struct camera_settings camera;
	void *options; /* the driver's; borrowed */
	enum deinterlace deinterlace;
	struct transfer_curve
		curve; /* how linear radiance becomes 8-bit code values, where it must */
};

struct source {
	struct source_settings settings;
	struct camera camera; /* the opener's while opening */
	struct opener *opener;
	bool opening;
	unsigned openings;		 /* that went well */
	bool tried;			 /* an opening has ended, well or not */
	enum camera_situation situation; /* of the camera, as far as we know */
	enum camera_situation said;	 /* the situation that was logged last */
	char device_name[128];		 /* of the camera that was open last; empty: it has none */
	struct frame held;		 /* grabbed, not given back; PIXEL_NONE: nothing */
	bool shown;			 /* held is the picture, raw */
	bool kept;			 /* its user's: each picture is to outlive its frame */
	int64_t held_ns;		 /* when it was captured */
	int64_t heard_ns;		 /* when the camera last gave something, or was opened */
	uint64_t superseded;		 /* held frames for which a newer one came */
	uint64_t undecodable;
	uint64_t earlier_frames, earlier_lost, earlier_broken; /* of openings before this one */

	struct frame_decoder *decoder;
	struct transfer_tables *tables;
	struct canvas canvas; /* of the picture's size; width 0: there has been none */
	bool whole;	      /* the picture is in it */
	struct image linear;  /* the same before it was clipped, of a camera that gives RGBF */
	bool is_linear;
	int64_t picture_ns; /* when the picture was captured */
	int64_t stamp_ns;   /* the same by the camera's own clock, which may be a simulated one */
	uint32_t sequence;  /* its number at the camera */
	int64_t fresh_ns;   /* when it became the picture */
};

/* 0, -ENOMEM, or what keeps a thread from being started. */
int source_create(struct source *source, const struct source_settings *settings);
/* Waits for an opening that has begun. Idempotent; zeroed is fine. */
void source_destroy(struct source *source);

/* Begins to open the camera: source_descriptor() polls readable when that has ended, and
 * source_take() takes it in. Nothing happens when it is open or being opened. */
void source_open(struct source *source);

bool source_is_open(const struct source *source);

/* What the device calls itself, or else what the configuration does. */
const char *source_device_name(const struct source *source);

/* A descriptor to poll, -1 while there is nothing to wait for: a camera that makes frames on demand
 * is left alone while its last one is held. */
int source_descriptor(struct source *source);

/*
 * Takes what the descriptor announced: the end of an opening, or the newest frame, if there is one.
 * A camera that is gone is closed, and said so once; one that sends another size or standard now is
 * opened again at once. 0, or what opening said, with its fault: only the caller knows what that
 * means, source_complain() or the end.
 */
int source_take(struct source *source, int64_t now_ns, struct fault *fault);

/* Logs a situation that differs from the one logged last. */
void source_complain(struct source *source, const struct fault *fault);

/* Once a second: names a camera that has fallen silent, closes it after a while. */
void source_watch(struct source *source, int64_t now_ns);

/* Nobody listened until now, so silence until now means nothing. */
void source_excuse(struct source *source, int64_t now_ns);

bool source_has_news(const struct source *source);
/* None either while the frame that was the picture has been given back for news. */
bool source_has_picture(const struct source *source);

/* Makes what is held the picture. False: it is of no use, and given back; the picture before it
 * stays. */
bool source_decode(struct source *source, int64_t now_ns);

/* Converts the picture into canvas, unless it is there. Only with a picture. */
void source_make_whole(struct source *source);

/* Gives back what is held, whether it was the picture or not. */
void source_drop(struct source *source);

/* As camera_set_control(); -EBADF while it is not open. */
int source_control(struct source *source, const char *name, const char *value, double *taken,
		   struct fault *fault);

/* How linear radiance becomes code values from now on. */
void source_encode_as(struct source *source, const struct transfer_curve *curve);

struct source_counts {
	uint64_t frames, lost, broken; /* lost: also superseded; broken: also undecodable */
};

struct source_counts source_counts(const struct source *source);

#endif
