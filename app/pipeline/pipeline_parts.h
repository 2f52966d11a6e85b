/* SPDX-License-Identifier: MIT */
/* Private to app/pipeline/pipeline*.c and its unit tests. */
#ifndef INLAY_APP_PIPELINE_PIPELINE_PARTS_H
#define INLAY_APP_PIPELINE_PIPELINE_PARTS_H

#include "app/pipeline/pipeline.h"
#include "hal/lights/lamp/lamp_light.h"
#include "hal/lights/light_filter.h"
#include "hal/lights/recovery.h"
#include "hal/mirror/mirror_eye.h"

/* Two poses whose pictures are mixed, next by share; pose alone where share is 0. */
struct pipeline_poses {
	int pose, next;
	double share;
};

/* pipeline_light.c, pipeline_ground.c: measuring the light */
struct pipeline_light {
	struct fisheye lens; /* for pictures of this size; width 0: none has come */
	int lens_width, lens_height;
	struct light_sampler *sampler;
	struct relight *relight; /* the next sampler and lens while they are made; NULL: none */
	struct light_exposures *exposures;
	int exposure;	    /* of the fisheye's next picture; -1: not known */
	uint64_t unfit;	    /* pictures that had another exposure than was set */
	double level;	    /* of the last picture: mean of its lights, 1 is white */
	float (*merged)[3]; /* [basis lights * parts]: of all exposures, before it is placed */
	float *left;	    /* [basis lights]: share that is clipped in every exposure, 0..1 */
	struct light_filter *filter;
	struct image upright; /* linear radiance as the view shows it */
	float (*radiance)[3]; /* [basis lights]: measured, recovered and filtered */
	bool lit;	      /* radiance has been measured or given */
	double clipped;	      /* share of the sky's solid angle clipped in every exposure */
	struct coarse_lamp lamp;
	struct lamps_search *lamps_search;
	struct lamps_told told;
	bool told_due;	       /* the next picture of the shortest exposure is looked at */
	struct ground *ground; /* finds on the ground what clips; NULL: no patch */
	struct light_recovery recovery;
};

/* pipeline_mirror.c: the sky as mirrors show it */
struct pipeline_mirror {
	bool on;	/* some pose of the basis mirrors the sky */
	bool seen, due; /* a picture has been taken; the map has to be filled from it */
	struct mirror_eye eye;
	struct mirror_map map;
	int limit[3];	      /* poses and first level that the map is limited to */
	float (*measured)[3]; /* [basis lights]: light when the picture was taken */
	float *clipped;	      /* [basis lights]: shares that clipped in all exposures then */
	double (*more)[3];    /* [basis lights]: to add to clipped pixels; or lights */
};

/* pipeline_pose.c: which poses are in the picture */
struct pipeline_pose {
	struct pipeline_poses shown;  /* pose -1: none yet */
	struct pipeline_poses coming; /* shown as soon as they are in memory */
	int expected[4];	      /* coming and shown, at the last basis_poses_expect() */
	bool backwards;		      /* the last step went to the pose before */
	bool expect_again;	      /* call basis_poses_expect() again */
	int missing;		      /* chosen, and cannot be loaded; -1: none */
	struct fault trouble;	      /* why */
};

struct pipeline {
	struct pipeline_settings settings;
	struct pipeline_choice choice; /* its poses: those in the picture */
	const struct basis *basis;     /* borrowed */
	struct pool *pool;
	struct dome dome;
	struct dome_placed *placed; /* NULL: it has too few lights */
	struct pipeline_light light;
	struct pipeline_mirror mirror;
	struct pipeline_pose pose;

	struct light_selection selection;
	bool followed; /* the selection has been multiplied by the camera's exposure */
	struct compositor *compositor;
	struct lamp_light *lamps;   /* NULL: there are none at places */
	float (*distant)[3];	    /* [lights]: the light without them */
	struct pipeline_fade *fade; /* pipeline_fade.c; NULL: no two poses have been mixed */

	/* what is found in the background camera's frames */
	int64_t looked_ns;		 /* capture time of the last one examined; -1: none */
	int64_t look_ns[PIPELINE_LOOKS]; /* spent on them since the last choice */
	struct exposure *follower;	 /* hal/look; NULL: the camera's exposure is not followed */
	struct flicker *flicker;	 /* of lamps, in its rows; where the exposure is followed */
	struct pipeline_grain *grain;	 /* pipeline_grain.c; NULL: the object gets no noise */
	struct pipeline_people *people;	 /* pipeline_people.c; NULL: nobody is looked for */
};

/* ---- pipeline_level.c ---- */

/*
 * What the sampler multiplies grey light by, as the mean over the three channels:
 *
 *     gain * (sum of colours[0..8]) / 3, or gain where colours are not set (all 0)
 */
double pipeline_gain_of_grey(const struct light_sampler_settings *settings);

/* Radiance of a grey level, 0..255, of the fisheye's picture, as the sampler would read it. */
double pipeline_linear_level(const struct light_sampler_settings *settings, double level);

/* Width of the hysteresis below a threshold, in radiance: one grey level, and twice what the
 * sampler may round, so that a light exactly one level below still counts as there. */
double pipeline_band_below(const struct light_sampler_settings *settings, double threshold);

/* ---- pipeline_ground.c ---- */

/* Prepares for the settings' patch in place of the one before, which stays on failure. Returns what
 * pipeline_check_patch() returns, or -ENOMEM. */
int pipeline_ground_prepare(struct pipeline *pipeline, const struct pipeline_settings *settings,
			    struct fault *fault);
void pipeline_ground_free(struct pipeline *pipeline); /* idempotent; zeroed is fine */

/* ---- pipeline_people.c ---- */

/* Begins to look for people, or ends it, as the settings say. What was learned of the place is lost
 * where the background's transfer function has changed. Returns what people_create() returns. */
int pipeline_people_prepare(struct pipeline *pipeline, const struct pipeline_settings *settings,
			    struct fault *fault);
void pipeline_people_free(struct pipeline *pipeline); /* idempotent; zeroed is fine */

/* Looks at a frame. fresh: for the first time; else only where the pose has changed since. */
void pipeline_people_look(struct pipeline *pipeline, const struct picture *background,
			  const struct depth_map *depth, int64_t captured_ns, bool fresh);

/* What the last look saw; NULL: nobody. */
const struct veil *pipeline_veil(const struct pipeline *pipeline);
struct pipeline_people_seen pipeline_people_seen(const struct pipeline *pipeline);

/* The background camera's noise, where people are looked for; else NULL. */
const struct sensor_noise *pipeline_people_noise(const struct pipeline *pipeline);

/* ---- pipeline_exposure.c ---- */

/* Begins to follow the background camera's exposure, or ends it, as the settings say. A change of
 * the transfer function begins anew. -ENOMEM. */
int pipeline_exposure_prepare(struct pipeline *pipeline, const struct pipeline_settings *settings,
			      struct fault *fault);
void pipeline_exposure_free(struct pipeline *pipeline); /* idempotent; zeroed is fine */

/* Looks at a frame. */
void pipeline_exposure_look(struct pipeline *pipeline, const struct picture *background);

/* Multiplies the chosen lights by the exposure that the last look found, once for each choice. The
 * shadow does not change: all lights of a channel become brighter alike. */
void pipeline_exposure_follow(struct pipeline *pipeline);

/* Lamps that flicker, in the rows of the last frame looked at (struct compositor_settings). */
const int32_t (*pipeline_rows(const struct pipeline *pipeline))[3];

/* ---- pipeline_grain.c ---- */

/* Begins to measure the background camera's noise, or ends it, as the settings say. What was
 * measured is lost where the transfer function has changed. -ENOMEM. */
int pipeline_grain_prepare(struct pipeline *pipeline, const struct pipeline_settings *settings,
			   struct fault *fault);
void pipeline_grain_free(struct pipeline *pipeline); /* idempotent; zeroed is fine */

/* Looks at a frame, after pipeline_people_look(). seed: of the noise that its composite gets. */
void pipeline_grain_watch(struct pipeline *pipeline, const struct picture *background,
			  uint64_t seed);

/* The noise for the next composite; NULL: none, or not measured yet. */
const struct grain *pipeline_grain(const struct pipeline *pipeline);

/* ---- pipeline_mirror.c ---- */

/* Begins, where a pose mirrors the sky. -ENOMEM, -EINVAL. */
int pipeline_mirror_prepare(struct pipeline *pipeline, struct fault *fault);
void pipeline_mirror_free(struct pipeline *pipeline); /* idempotent; zeroed is fine */

/* Tells that lights were given, without a picture. */
void pipeline_mirror_given(struct pipeline *pipeline);

/* Takes the picture that the light was just measured in; one of both. -ENOMEM. */
int pipeline_mirror_take(struct pipeline *pipeline, const struct frame_reader *frame,
			 const struct image *linear);

/* Gives the selection the sky that mirrors show, with light that the picture clips where the
 * measured light has it. */
void pipeline_mirror_show(struct pipeline *pipeline);

/* ---- pipeline_pose.c, pipeline_fade.c, pipeline_light.c ---- */

/* Sets the poses of pipeline->choice: the chosen ones, or those before them. An error, with its
 * reason in pipeline->trouble, where there are none before. */
int pipeline_take_poses(struct pipeline *pipeline, const struct pipeline_choice *choice);

/* Allocates the pictures of two poses; idempotent. 0 or -ENOMEM. */
int pipeline_fade_begin(struct pipeline *pipeline);
/* Writes the two poses of pipeline->choice, mixed by its share. Returns what compositor_run()
 * returns. */
int pipeline_fade_run(struct pipeline *pipeline, const struct backdrop *background, uint8_t *out,
		      size_t out_stride);
void pipeline_fade_end(struct pipeline *pipeline);

/* Waits for the thread of pipeline_relight() and drops what it has made. Idempotent. */
void pipeline_relight_end(struct pipeline *pipeline);

#endif
