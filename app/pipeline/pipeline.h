/* SPDX-License-Identifier: MIT */
/*
 * From two pictures to one: light from the fisheye's, the object into the background's. No cameras,
 * no screens, no files: `run` and `still` both go through here, so what one shows the other shows.
 *
 * Each frame: pipeline_light_*(), pipeline_recover(), pipeline_follow() where frames follow each
 * other, then pipeline_choose(), then pipeline_composite(). Light stays until it is measured again.
 * Nothing is allocated after the first frame of a size.
 */
#ifndef INLAY_APP_PIPELINE_PIPELINE_H
#define INLAY_APP_PIPELINE_PIPELINE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/base/pool.h"
#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/frame/view.h"
#include "hal/image/image.h"
#include "hal/lights/exposures.h"
#include "hal/lights/light_filter.h"
#include "hal/lights/recovery.h"
#include "hal/lights/sampler.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"

#define PIPELINE_KERNEL_MAX 256

/* Ground in the background's picture, which tells what the fisheye clips: recovery.h. */
struct pipeline_patch {
	int x, y, width, height; /* px; width 0: none */
	double reflectance[3];	 /* all 0: that of the ground that was baked */
};

struct pipeline_settings {
	struct light_sampler_settings sampler;
	struct fisheye_settings lens;
	/* The fisheye's pictures are of so many exposures, of which each lets in this share of the
	 * first one's light: exposures.h. 0 and 1: they are all alike. */
	int exposures;
	double exposure[EXPOSURES_MAX];
	struct pipeline_patch patch;
	int64_t follow_ns; /* a switched light is at 90 % by then (light_filter.h); 0: at once */
	enum threshold_mode threshold_mode;
	struct transfer_curve
		background; /* of the background's code values, and of what comes out */
	double gain;
	int threads;		   /* 0: one for each processor */
	enum compositor_mode mode; /* exact only where the basis was opened with that layer */
	enum compositor_reuse reuse;
	char kernel[PIPELINE_KERNEL_MAX]; /* compositor.h; empty: auto */
};

/* What buttons change from frame to frame. */
struct pipeline_choice {
	/* 8-bit grey level of the fisheye's picture, 0..255. A light in use stays so until it is
	 * more than one level below, as long as neither this nor the mode changes. Or a percentage
	 * of white, which what is left out cannot change any pixel by (compositor.h); 0: all are
	 * used. */
	struct ini_level threshold;
	int pose;
	bool object;
	/* Between two poses, their pictures are mixed in linear light: pose by 1 - share, next by
	 * share, 0..1. Above 0 that costs two composites, and the background is made twice. Light
	 * is chosen for the nearer of the two. */
	double share;
	int next;
	/* Of poses that are not in memory yet: what was shown before goes on being shown until they
	 * are, so that no frame waits; else the frame waits for them. */
	bool hold;
};

/* What a picture is made of: two poses, or one where share is 0. */
struct pipeline_poses {
	int pose, next;
	double share;
};

struct pipeline {
	struct pipeline_settings settings;
	struct pipeline_choice choice; /* of poses: what is shown */
	const struct basis *basis;     /* borrowed */
	struct pool *pool;
	struct dome dome;
	struct fisheye lens; /* of pictures of this size; width 0: not known yet */
	int lens_width, lens_height;
	struct light_sampler *sampler;
	struct relight *relight; /* private: the next sampler and lens, in the making */
	struct light_exposures *exposures;
	int exposure;	       /* of the fisheye's picture that comes next, set by who knows; -1:
				  nobody does */
	uint64_t unfit;	       /* pictures that had another than was set */
	double level;	       /* of the last one: the mean of its lights, 1 is white */
	float (*sampled)[3];   /* [basis lights]: what it shows */
	float *left;	       /* [basis lights]: share that is clipped in every exposure */
	struct ground *ground; /* private: the patch, NULL: none */
	struct light_recovery recovery; /* what the patch has told */
	struct light_filter *filter;
	struct image upright; /* linear radiance as the view shows it */
	float (*radiance)[3]; /* [basis lights]: what was measured, or made of it over time */
	bool lit;	      /* there has been light to measure */
	double clipped;	      /* share of the sky that is at its limit in every exposure, 0..1 */
	struct light_selection selection;
	struct compositor *compositor;
	struct pipeline_fade *fade;   /* private: between two poses; NULL: not yet */
	struct pipeline_poses shown;  /* private: pose -1: none yet */
	struct pipeline_poses coming; /* private: shown when they are in memory */
	int expected[4];	      /* private: poses that others were expected from */
	bool back;		      /* private: the last step was one back */
	bool again;		      /* private: they are to be expected anew */
	int missing;	      /* pose that was chosen and cannot be had: those before it stay; -1 */
	struct fault trouble; /* why */
};

/* -EINVAL: a basis whose lights are no dome's; a value out of range. */
int pipeline_create(struct pipeline *pipeline, const struct basis *basis,
		    const struct pipeline_settings *settings, struct fault *fault);
void pipeline_destroy(struct pipeline *pipeline); /* idempotent; zeroed is fine */

/* Other settings from the next frame on, but for those of the sampler, the lens and the exposures.
 * On failure the old ones stay. */
int pipeline_change(struct pipeline *pipeline, const struct pipeline_settings *settings,
		    struct fault *fault);

/* Those of the sampler and the lens: a thread prepares them, and they count from the first light
 * that is measured after that. Light that has been measured stays. */
int pipeline_relight(struct pipeline *pipeline, const struct pipeline_settings *settings,
		     struct fault *fault);

/* Whether the patch lies in the basis's picture and has a reflectance; none is fine. 0 or -EINVAL.
 */
int pipeline_check_patch(const struct pipeline_patch *patch, const struct basis *basis,
			 struct fault *fault);

/* Whether a background of this size is the basis's. 0 or -EINVAL. */
int pipeline_fits(const struct pipeline *pipeline, int width, int height, struct fault *fault);

/* The fisheye's next picture has this exposure, -1: nobody knows; ratio[settings.exposures]: what
 * each lets in of the first one's light. Not looked at where pictures are all alike. */
void pipeline_expose(struct pipeline *pipeline, int exposure, const double *ratio);

/* Measures the light, of the exposure that is set: in 8-bit code values, of a frame as the camera
 * sent it or of a picture; in linear radiance, of which view is the sky; or as somebody measured
 * it: radiance[basis lights]. -ESTALE: nobody knows the picture's exposure, or it is not the one
 * that was set; level is the picture's, light stays. */
int pipeline_light_frame(struct pipeline *pipeline, const struct frame_reader *fisheye,
			 struct fault *fault);
int pipeline_light_picture(struct pipeline *pipeline, const struct picture *fisheye,
			   struct fault *fault);
int pipeline_light_linear(struct pipeline *pipeline, const struct image *camera,
			  const struct view *view, struct fault *fault);
void pipeline_light_given(struct pipeline *pipeline, const float (*radiance)[3]);

/* Adds what the sky's clipped parts must be to the light that was just measured: background is the
 * upright view at about that time. Nothing, where nothing clips or there is no patch in it. */
void pipeline_recover(struct pipeline *pipeline, const struct frame_reader *background);

/* The light that was just measured is of a frame captured then (CLOCK_MONOTONIC, or a simulated
 * camera's own clock): what it becomes of the light before it. The first, and the first of another
 * size or other settings of the sampler, stays as it is. */
void pipeline_follow(struct pipeline *pipeline, int64_t captured_ns);

/* -EINVAL: no such pose. A pose that cannot be had, as its file has been damaged or memory is
 * short, is an error only where there is none to be shown in its place: missing. */
int pipeline_choose(struct pipeline *pipeline, const struct pipeline_choice *choice,
		    struct fault *fault);

/* If a pose is missing, it is tried once more with the next choice. */
void pipeline_try_again(struct pipeline *pipeline);

/* Writes a BGRX picture of the basis's size, which the background must have: -EINVAL. */
int pipeline_composite(struct pipeline *pipeline, const struct backdrop *background, uint8_t *out,
		       size_t out_stride, struct fault *fault);

/* The same in double precision, of the exact layer where the basis was opened with it:
 * out[height][width][3], R G B, 0..255, not rounded. Slow. */
int pipeline_reference(struct pipeline *pipeline, const struct picture *background, double *out,
		       struct fault *fault);

#endif
