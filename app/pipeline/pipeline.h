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

struct pipeline;

/* What the last measurement of light and the last choice gave. */
struct pipeline_report {
	bool lit;	/* light has been measured, or given, at least once */
	double level;	/* of the fisheye's last picture: mean of its lights, 1 is white */
	double clipped; /* share of the sky's solid angle at the limit in every exposure, 0..1 */
	bool recovered; /* the patch of ground has told what is missing there */
	bool at_bound;	/* but not all of it */
	int exposures;	/* that the fisheye's camera takes in turn, at least 1 */
	uint64_t unfit; /* its pictures that had another exposure than they should */
	struct ini_level threshold;
	int lights, lights_used;
	double dropped_error; /* no pixel of the object is off by more, in any channel: linear
				 light, 1 is white, gain applied */
	int pose;	      /* in the picture; where two are mixed, the first */
	int missing;	      /* pose that was chosen and cannot be loaded; -1: none */
};

/* -EINVAL: a basis whose lights are no dome's; a value out of range. */
int pipeline_create(struct pipeline **pipeline, const struct basis *basis,
		    const struct pipeline_settings *settings, struct fault *fault);
void pipeline_destroy(struct pipeline *pipeline); /* NULL is harmless */

/* Other settings from the next frame on, but for those of the sampler, the lens and the exposures.
 * On failure the old ones stay. */
int pipeline_change(struct pipeline *pipeline, const struct pipeline_settings *settings,
		    struct fault *fault);

/* Those of the sampler and the lens: a thread prepares them, and they count from the first light
 * that is measured after that. Light that has been measured stays. */
int pipeline_relight(struct pipeline *pipeline, const struct pipeline_settings *settings,
		     struct fault *fault);

/* Whether fisheye_prepare() takes these settings for the size of the fisheye's pictures; 0 as long as
 * none has come. */
int pipeline_check_lens(const struct pipeline *pipeline, const struct fisheye_settings *lens,
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
 * that was set; report.level is the picture's, light stays. */
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

struct pipeline_report pipeline_report(const struct pipeline *pipeline);

/* Why report.missing cannot be loaded. */
const char *pipeline_trouble(const struct pipeline *pipeline);

/* Whether pipeline_recover() has a patch of ground to look at. */
bool pipeline_has_patch(const struct pipeline *pipeline);

/* The pipeline's own, valid until it is changed: its threads; the dome of the basis; the lens for the
 * size of the fisheye's last picture; whether each light is in use, radiance of each light
 * ([basis lights]). */
struct pool *pipeline_pool(const struct pipeline *pipeline);
const struct dome *pipeline_dome(const struct pipeline *pipeline);
const struct fisheye *pipeline_lens(const struct pipeline *pipeline);
const bool *pipeline_used(const struct pipeline *pipeline);
const float (*pipeline_radiance(const struct pipeline *pipeline))[3];

#endif
