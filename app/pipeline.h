/*
 * From two pictures to one: light from the fisheye's, the object into the background's. No cameras,
 * no screens, no files: `run` and `still` both go through here, so what one shows the other shows.
 *
 * Each frame: pipeline_light_*(), then pipeline_choose(), then pipeline_composite(). Light stays
 * until it is measured again. Nothing is allocated after the first frame of a size.
 */
#ifndef INLAY_APP_PIPELINE_H
#define INLAY_APP_PIPELINE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/fault.h"
#include "hal/image/image.h"
#include "hal/lights/sampler.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"
#include "hal/pool.h"
#include "hal/view.h"

#define PIPELINE_KERNEL_MAX 256

struct pipeline_settings {
	struct light_sampler_settings sampler;
	struct fisheye_settings lens;
	enum threshold_mode threshold_mode;
	enum transfer background; /* of the background's code values, and of what comes out */
	double gain;
	int threads;		   /* 0: one for each processor */
	enum compositor_mode mode; /* exact only where the basis was opened with that layer */
	enum compositor_reuse reuse;
	char kernel[PIPELINE_KERNEL_MAX]; /* compositor.h; empty: auto */
};

/* What buttons change from frame to frame. */
struct pipeline_choice {
	double threshold; /* 8-bit grey level of the fisheye's picture, 0..255 */
	int pose;
	bool object;
};

struct pipeline {
	struct pipeline_settings settings;
	struct pipeline_choice choice;
	const struct basis *basis; /* borrowed */
	struct pool *pool;
	struct dome dome;
	struct fisheye lens; /* of pictures of this size; width 0: not known yet */
	int lens_width, lens_height;
	struct light_sampler *sampler;
	struct relight *relight; /* private: the next sampler and lens, in the making */
	struct image upright;	 /* linear radiance as the view shows it */
	float (*radiance)[3];	 /* [basis lights]: what was measured */
	bool lit;		 /* there has been light to measure */
	double clipped;		 /* share of the sky that was at its limit, 0..1 */
	struct light_selection selection;
	struct compositor *compositor;
	int64_t sample_ns, composite_ns; /* what the last calls took */
};

/* -EINVAL: a basis whose lights are no dome's; a value out of range. */
int pipeline_create(struct pipeline *pipeline, const struct basis *basis,
		    const struct pipeline_settings *settings, struct fault *fault);
void pipeline_destroy(struct pipeline *pipeline); /* idempotent; zeroed is fine */

/* Other settings from the next frame on, but for those of the sampler and the lens. On failure the
 * old ones stay. */
int pipeline_change(struct pipeline *pipeline, const struct pipeline_settings *settings,
		    struct fault *fault);

/* Those of the sampler and the lens: a thread prepares them, and they count from the first light
 * that is measured after that. Light that has been measured stays. */
int pipeline_relight(struct pipeline *pipeline, const struct pipeline_settings *settings,
		     struct fault *fault);

/* Whether a background of this size is the basis's. 0 or -EINVAL. */
int pipeline_fits(const struct pipeline *pipeline, int width, int height, struct fault *fault);

/* Measures the light: in 8-bit code values, of a frame as the camera sent it or of a picture; in
 * linear radiance, of which view is the sky; or as somebody measured it: radiance[basis lights]. */
int pipeline_light_frame(struct pipeline *pipeline, const struct frame_reader *fisheye,
			 struct fault *fault);
int pipeline_light_picture(struct pipeline *pipeline, const struct picture *fisheye,
			   struct fault *fault);
int pipeline_light_linear(struct pipeline *pipeline, const struct image *camera,
			  const struct view *view, struct fault *fault);
void pipeline_light_given(struct pipeline *pipeline, const float (*radiance)[3]);

/* -EINVAL: no such pose. */
int pipeline_choose(struct pipeline *pipeline, const struct pipeline_choice *choice,
		    struct fault *fault);

/* Writes a BGRX picture of the basis's size, which the background must have: -EINVAL. */
int pipeline_composite(struct pipeline *pipeline, const struct backdrop *background, uint8_t *out,
		       size_t out_stride, struct fault *fault);

/* The same in double precision, of the exact layer where the basis was opened with it:
 * out[height][width][3], R G B, 0..255, not rounded. Slow. */
int pipeline_reference(struct pipeline *pipeline, const struct picture *background, double *out,
		       struct fault *fault);

#endif
