/* SPDX-License-Identifier: MIT */
/* A camera that may fail and come back, what opens it, and whether its pictures have settled. */
#ifndef INLAY_APP_CAMERA_SOURCE_H
#define INLAY_APP_CAMERA_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/clock.h"
#include "hal/colour/transfer.h"
#include "hal/device/camera.h"
#include "hal/frame/frame.h"
#include "hal/frame/frame_reader.h"
#include "hal/image/image.h"

/*
 * Opens a camera on a thread of its own, because a device may be slow: the event loop goes on with
 * the other cameras and the screen. Thread and descriptor last as long as the opener, so that a
 * camera which is tried again every second makes no new ones.
 */

struct opener;

/* 0 or -errno. The thread has all signals blocked. */
int opener_create(struct opener **opener);

/* Begins to open the camera. camera, settings and options belong to the opener until opener_take()
 * has returned true. Not while another camera is being opened. */
void opener_start(struct opener *opener, struct camera *camera, const struct camera_ops *ops,
		  const struct camera_settings *settings, void *options);

/* Polls readable when opener_take() will return true. */
int opener_descriptor(const struct opener *opener);

/* False: the camera is still being opened. True, once: opening has ended; *err and *fault are what
 * camera_open() returned. */
bool opener_take(struct opener *opener, int *err, struct fault *fault);

/* Waits for an opening that has begun; then the camera belongs to the caller, perhaps open. NULL is
 * harmless. */
void opener_destroy(struct opener *opener);

/*
 * Whether a camera's pictures can be believed already: after it was opened, a camera may send black
 * frames, green ones (YUV buffers of zeros, which nobody has filled), and frames whose exposure and
 * white balance are still being found. They are left out of the light.
 *
 * A picture is blank where no pixel has red or blue. Pictures count once their mean level has
 * stayed within 4 % (or one code value) for SETTLING_STEADY_NS and three pictures, and in any case
 * SETTLING_MOST_NS after the first one: a dark night is black for ever. Pure: asks no clock.
 */

#define SETTLING_STEADY_NS (300 * NS_PER_MS)
#define SETTLING_MOST_NS (3 * NS_PER_S)
/* For a picture that is kept: at 8 Hz an exposure that takes five seconds changes by less than 4 %
 * in a third of a second. */
#define SETTLING_KEPT_STEADY_NS NS_PER_S
#define SETTLING_KEPT_MOST_NS (10 * NS_PER_S)

struct settling {
	unsigned opening;  /* the camera's opening that this is about; 0: none yet */
	bool settled;	   /* its pictures count */
	bool in_vain;	   /* only because they were waited for long enough */
	bool kept;	   /* set by the user: one picture is kept, so the times are longer */
	uint64_t left_out; /* pictures that did not, of all openings */
	int64_t begun_ns;  /* when its first picture was captured */
	int64_t steady_ns; /* since when its level has been steady */
	double level;	   /* which level that is; < 0: none, the last picture was blank */
	int steady;	   /* pictures of that level */
};

/* What a picture looks like. */
struct settling_look {
	double level; /* mean code value */
	bool blank;
};

struct settling_look settling_look_at(const struct frame_reader *picture);

/* Takes a picture of this opening (1 or more) that was captured at a time. metering: the camera
 * finds its exposure itself; else only blank pictures are left out. Returns whether the picture
 * counts. */
bool settling_take(struct settling *settling, unsigned opening, const struct settling_look *look,
		   bool metering, int64_t captured_ns);

/*
 * A camera as the program uses it: it is opened on a thread of its own, opened again after it was
 * lost, and its newest frame is held until a picture is made.
 *
 * A raw frame becomes the picture as it is: readers take pixels from the memory that the camera
 * filled (hal/frame/frame_reader.h), it is converted whole only on request, and it goes back to the
 * camera when the next frame comes. Other frames are decoded whole and given back at once. Either
 * way the last picture stays when the camera is lost.
 */

struct source_settings {
	const char *name; /* in the configuration; borrowed */
	const struct camera_ops *ops;
	struct camera_settings camera;
	void *options; /* for the driver; borrowed */
	enum deinterlace deinterlace;
	enum picture_turn turn;	     /* makes the camera's pictures upright; not of RGBF */
	struct transfer_curve curve; /* encodes linear radiance as 8-bit code values */
};

/* Opening the camera, and what is known of it. */
struct source_opening {
	struct opener *opener;
	bool begun;			 /* and not ended yet */
	bool resting;			 /* the camera stays closed: source_rest() */
	unsigned count;			 /* openings that succeeded */
	bool tried;			 /* an opening has ended, with or without success */
	enum camera_situation situation; /* of the camera, as last known */
	enum camera_situation said;	 /* the situation that was logged last */
	struct fault why;		 /* its reason, as it was logged; empty: none */
	char device_name[128]; /* name of the device that was open last; empty: it has none */
};

struct source_tallies {
	uint64_t losses;     /* how often the camera was lost after it had given a picture */
	uint64_t superseded; /* held frames that a newer one replaced */
	uint64_t undecodable;
	uint64_t frames, lost, broken; /* the camera's own, of the openings before this one */
};

struct source {
	struct source_settings settings;
	struct camera camera; /* belongs to the opener while opening */
	struct source_opening opening;
	struct frame held; /* frame that was grabbed and not given back; PIXEL_NONE: none */
	bool shown;	   /* the held frame is raw and is the picture */
	bool kept;	   /* set by the user: pictures outlive their frames (freeze) */
	int64_t held_ns;   /* when the held frame was captured */
	int64_t heard_ns;  /* when the camera last gave a frame, or was opened */
	struct source_tallies counts;

	struct frame_decoder *decoder;
	struct transfer_tables *tables;
	struct canvas canvas; /* has the picture's size; width 0: there has been no picture */
	bool whole;	      /* the picture is in the canvas */
	struct canvas spare;  /* compressed frames are decoded here: a damaged one is never shown */
	int odd_width, odd_height; /* the last JPEG picture of another size than agreed; 0: none */
	int64_t damaged_ns;	   /* since when no frame has decoded; 0: the last one did */
	struct image linear;	   /* the picture in linear radiance, not clipped, from RGBF */
	bool is_linear;
	int64_t picture_ns;	  /* when the picture was captured */
	int64_t stamp_ns;	  /* the same by the camera's own clock, perhaps a simulated one */
	uint32_t sequence;	  /* the camera's number of its frame */
	int64_t fresh_ns;	  /* when it became the picture */
	struct settling settling; /* whether the picture counts: eye_has_settled() */
};

/* 0, -ENOMEM, or -errno of a thread that cannot be started. */
int source_create(struct source *source, const struct source_settings *settings);
/* Waits for an opening that has begun. Idempotent; zeroed is fine. */
void source_destroy(struct source *source);

/* Begins to open the camera, unless it is open or being opened. source_descriptor() polls readable
 * when that has ended; source_take() then takes the result. */
void source_open(struct source *source);

/* resting: closes the camera and forgets its picture, and until the opposite is said it stays
 * closed. No trouble, and nothing is logged. */
void source_rest(struct source *source, bool resting);

bool source_is_open(const struct source *source);

/* Size of the pictures that an open camera has agreed to, turned upright. */
void source_size(const struct source *source, int *width, int *height);

/* The device's own name, else the configuration's. */
const char *source_device_name(const struct source *source);

/* Returns a descriptor to poll; -1: nothing to wait for. A camera that makes frames on demand is
 * not asked while its last frame is held. */
int source_descriptor(struct source *source);

/*
 * Takes what the descriptor has announced: the end of an opening, or the newest frame. A camera
 * that is gone is closed, which is logged once; a camera that now sends another size or standard is
 * opened again at once. Returns 0, or the error of the opening with its fault: the caller decides
 * between source_complain() and the end.
 */
int source_take(struct source *source, int64_t now_ns, struct fault *fault);

/* Logs a situation that differs from the one logged last. */
void source_complain(struct source *source, const struct fault *fault);

/* To be called once a second: logs a camera that has fallen silent, and closes it after some more
 * silence. */
void source_watch(struct source *source, int64_t now_ns);

/* Forgets the silence until now: the program itself did not listen. */
void source_excuse(struct source *source, int64_t now_ns);

bool source_has_news(const struct source *source);
/* False also between the return of the frame that was the picture and source_decode() of the
 * next. */
bool source_has_picture(const struct source *source);

/* Makes the held frame the picture. False: it cannot be decoded and is given back; the picture
 * before it stays. */
bool source_decode(struct source *source, int64_t now_ns);

/* Converts the picture into canvas, unless it is there. Does nothing without a picture. */
void source_make_whole(struct source *source);

/* Gives back the held frame, even if it is the picture. */
void source_drop(struct source *source);

/* As camera_set_control(); -EBADF while it is not open. */
int source_control(struct source *source, const char *name, const char *value, double *taken,
		   struct fault *fault);

/* Encodes linear radiance by this curve from now on. */
void source_encode_as(struct source *source, const struct transfer_curve *curve);

struct source_counts {
	/* Lost includes superseded frames, broken those that do not decode. */
	uint64_t frames, lost, broken;
};

struct source_counts source_counts(const struct source *source);

#endif
