/* SPDX-License-Identifier: MIT */
/*
 * From two pictures to one: light from the fisheye's picture, the object into the background's. It
 * knows no cameras, screens or files, so that `run` and `still` make the same picture.
 *
 * For each frame call pipeline_light_*(), pipeline_recover(), and pipeline_follow() where frames
 * follow each other; then pipeline_choose(), pipeline_look(), then pipeline_composite(). Light
 * stays until it is measured again. Nothing is allocated after the first frame of a size. All calls
 * come from one thread; the pipeline has threads of its own.
 *
 * pipeline_light.c measures light, pipeline_ground.c recovers what is clipped, pipeline_pose.c
 * loads poses; everything else is in pipeline.c.
 */
#ifndef INLAY_APP_PIPELINE_PIPELINE_H
#define INLAY_APP_PIPELINE_PIPELINE_H

#include <stdbool.h>
#include <stdint.h>

#include "app/pipeline/coarse_lamp.h"
#include "app/pipeline/lamps_told.h"
#include "hal/base/fault.h"
#include "hal/base/pool.h"
#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/frame/depth.h"
#include "hal/frame/view.h"
#include "hal/image/image.h"
#include "hal/lights/exposures.h"
#include "hal/lights/lamps.h"
#include "hal/lights/sampler.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

#define PIPELINE_KERNEL_MAX 256
#define PIPELINE_CAMERA_MAX 2048
#define PIPELINE_LAMP_NAME_MAX 64

/* A rectangle of ground in the background's picture, whose brightness tells what the fisheye clips
 * (hal/lights/recovery.h). */
struct pipeline_patch {
	int x, y, width, height; /* px of the background's view; width 0: no patch */
	double reflectance[3];	 /* R, G, B; all 0: the ground of the basis */
};

struct pipeline_settings {
	struct light_sampler_settings sampler;
	struct fisheye_settings lens;
	/* Number of the fisheye's exposures, and the light that each lets in as a share of the
	 * first one's (exposures.h). 0 and 1: all pictures have the same one. */
	int exposures;
	double exposure[EXPOSURES_MAX];
	struct pipeline_patch patch;
	int64_t follow_ns; /* a switched light is at 90 % after it (light_filter.h); 0: at once */
	enum threshold_mode threshold_mode;
	/* Transfer function of the background's code values and of the result. */
	struct transfer_curve background;
	double gain;
	int threads;		   /* 0: one for each processor */
	enum compositor_mode mode; /* exact only where the basis was opened with that layer */
	char kernel[PIPELINE_KERNEL_MAX]; /* struct compositor_options; empty: auto */
	/* The object follows the background camera's exposure and white balance, and lamps that
	 * flicker in its rows (hal/look). */
	bool follow_exposure;
	double neutral; /* share of the light that is grey of the same luminance, 0..1 */
	bool grain;	/* the object gets the background camera's noise (hal/look) */
	bool occlude;	/* people are looked for, and stand before the object (hal/people) */
	/* Picture of the background's size, and nobody is looked for where it is darker than half;
	 * empty: people are looked for everywhere. */
	char mask[INI_PATH_MAX];
	/* Its pixels where pipeline_read_mask() has read them, and needed during the call only;
	 * NULL: the file is read. */
	const uint8_t *mask_pixels;
	struct lamps lamps; /* at places; ignored where the basis does not know its places */
	char lamp_name[LAMPS_MAX][PIPELINE_LAMP_NAME_MAX];
	struct tsai_camera depth_camera; /* see struct people_settings; width 0: none */
	/* Tells the background's camera and view: what is kept of a place is of one. */
	char camera[PIPELINE_CAMERA_MAX];
};

/* What may change from frame to frame. */
struct pipeline_choice {
	/* Grey level of the fisheye's 8-bit picture, 0..255: darker lights are left out, and a
	 * light in use stays in use until it is more than one level below (while level and mode
	 * stay the same). Or a percentage of white: lights are left out that together change no
	 * pixel by more (compositor.h). 0: all lights are used. */
	struct ini_level threshold;
	int pose;
	bool object;
	/*
	 * Between two poses: their pictures are mixed in linear light,
	 *
	 *     (1 - share) * picture of pose + share * picture of next,    0 <= share <= 1
	 *
	 * A share above 0 costs two composites, and reads the background twice. Light is chosen for
	 * the nearer pose.
	 */
	double share;
	int next;
	/* While the chosen poses are being loaded: true shows the poses before them meanwhile, so
	 * that no frame waits; false waits. */
	bool hold;
};

struct pipeline;

/* What the last look for people saw. */
struct pipeline_people_seen {
	bool on;	/* people are looked for */
	bool begun;	/* a frame has been looked at */
	double learned; /* share of the place around the object whose empty picture is known */
	int parts;	/* groups of people, and those of them in front of the object */
	int in_front;
	double sure; /* as in struct people_report */
	double moved_px[2];
	bool lost;
};

/* What is done for the camera's look. */
enum pipeline_look {
	PIPELINE_EXPOSURE, /* finding the camera's exposure */
	PIPELINE_FLICKER,  /* finding lamps that flicker, in its rows */
	PIPELINE_NOISE,	   /* measuring its noise, where nobody is looked for */
	PIPELINE_NEUTRAL,  /* making light neutral */
	PIPELINE_LOOKS
};

/* What the last measurement of light, the last choice and the last look gave. */
struct pipeline_report {
	bool lit;	/* light has been measured, or given, at least once */
	double level;	/* of the fisheye's last picture: mean over its lights, 1 is white */
	double clipped; /* share of the sky's solid angle at the limit in every exposure, 0..1 */
	bool recovered; /* the patch of ground has expected what is clipped, and it was added */
	bool at_bound;	/* but a bound cut it */
	int exposures;	/* exposures that the fisheye's camera takes in turn, at least 1 */
	uint64_t unfit; /* pictures whose light did not fit their exposure */
	struct ini_level threshold;
	int lights, lights_used;
	double dropped_error; /* bound for the change of any pixel of the object by the lights left
				 out, in any channel: linear light, 1 is white, gain applied */
	int pose;	      /* pose in the picture; the first of two */
	int missing;	      /* pose that was chosen and cannot be loaded; -1: none */
	struct coarse_lamp lamp; /* as pipeline_find_lamps() saw it last */
	struct lamps_told told;	 /* as the picture after that showed it */
	/* Names of the lamps that are missing, until the next change; NULL ends them. */
	const char *missing_lamp[LAMPS_MAX + 1];
	struct pipeline_people_seen people;
	int64_t look_ns[PIPELINE_LOOKS]; /* time since the last choice; 0: it is off */
};

/* The basis is borrowed. 0; -EINVAL: the basis's lights are no dome's, or a setting is out of
 * range; -ENOTSUP: no such kernel; -ENOMEM. *pipeline is set on success only. */
int pipeline_create(struct pipeline **pipeline, const struct basis *basis,
		    const struct pipeline_settings *settings, struct fault *fault);
void pipeline_destroy(struct pipeline *pipeline); /* NULL is harmless */

/* Warns where lamps at places are named, but the basis does not know its places. That is no error:
 * they are taken as distant, as all light was before. pipeline_create() and pipeline_change() do
 * it, too. */
void pipeline_warn_of_lamps(const struct basis *basis, const struct lamps *lamps);

/* Takes other settings from the next frame on, except those of sampler, lens and exposures. On
 * failure the old ones stay. */
int pipeline_change(struct pipeline *pipeline, const struct pipeline_settings *settings,
		    struct fault *fault);

/* Takes other settings of sampler and lens. A thread prepares them; they take effect with the first
 * measurement after that. Light that has been measured stays. */
int pipeline_relight(struct pipeline *pipeline, const struct pipeline_settings *settings,
		     struct fault *fault);

/* Makes ready for fisheye pictures of this size, which takes longer than a frame lasts: a thread
 * does it, unless wait is true. 0: it is; -EAGAIN: not yet, call again with the next picture; else
 * what fisheye_prepare() and light_sampler_create() return. The functions below that measure light
 * wait. */
int pipeline_light_prepare(struct pipeline *pipeline, int width, int height, bool wait,
			   struct fault *fault);

/* The size of the fisheye's pictures; 0 0: none has come. */
void pipeline_lens_size(const struct pipeline *pipeline, int *width, int *height);

/* Checks that the patch lies in the basis's picture and has a reflectance. 0, also without a patch,
 * or -EINVAL. */
int pipeline_check_patch(const struct pipeline_patch *patch, const struct basis *basis,
			 struct fault *fault);

/* Reads the file of settings.mask, which has to be a picture of the basis's size:
 * *pixels[height][width], which the caller frees, is 1 where people are looked for; NULL where path
 * is empty. 0 or what image_read_sized() returns, -ENOTSUP, -ENOMEM. */
int pipeline_read_mask(const char *path, const struct basis *basis, uint8_t **pixels,
		       struct fault *fault);

/* Checks that a background of this size is the basis's. 0 or -EINVAL. */
int pipeline_fits(const struct pipeline *pipeline, int width, int height, struct fault *fault);

/* Tells which exposure the fisheye's next picture has, -1: not known. ratio[settings.exposures]:
 * light that each lets in as a share of the first one's; ignored where all pictures have the same
 * exposure. */
void pipeline_expose(struct pipeline *pipeline, int exposure, const double *ratio);

/* Measures the light at the exposure that is set: from 8-bit code values of a frame as the camera
 * sent it, or of an upright picture; from linear radiance, of which view cuts out the sky; or takes
 * lights measured elsewhere, radiance[basis lights]. -ESTALE: the picture's exposure is not known,
 * or its light does not fit it; report.level is then this picture's, and the light stays as it
 * was. */
int pipeline_light_frame(struct pipeline *pipeline, const struct frame_reader *fisheye,
			 struct fault *fault);
int pipeline_light_picture(struct pipeline *pipeline, const struct picture *fisheye,
			   struct fault *fault);
int pipeline_light_linear(struct pipeline *pipeline, const struct image *camera,
			  const struct view *view, struct fault *fault);
void pipeline_light_given(struct pipeline *pipeline, const float (*radiance)[3]);

/* Until light is measured again there is none: report.lit is false, as at the start. */
void pipeline_forget_light(struct pipeline *pipeline);

/* Looks for a lamp that shines where the dome is coarse, and in the fisheye's next picture, of the
 * shortest exposure, for lamps that are missing or not named; once a second suffices. */
void pipeline_find_lamps(struct pipeline *pipeline);

/* [LAMPS_MAX]: whether each lamp at a place showed no light then; valid as long as the pipeline. */
const bool *pipeline_missing_lamps(const struct pipeline *pipeline);

/* Adds the light that the fisheye has clipped to the light just measured, by the patch of ground in
 * background, the upright view of about the same time. Does nothing where nothing is clipped or
 * there is no patch. */
void pipeline_recover(struct pipeline *pipeline, const struct frame_reader *background);

/* The radiance of the patch of ground as seen in background, and as the measured light and the
 * patch's given reflectance tell it. False: there is no patch of given reflectance, or it is
 * outside. */
bool pipeline_ground_expected(const struct pipeline *pipeline,
			      const struct frame_reader *background, double radiance[3],
			      double expected[3]);

/* Filters the light just measured over time (light_filter.h). captured_ns: when its frame was
 * captured, by CLOCK_MONOTONIC or the clock of a simulated camera. The first light stays as
 * measured, also after a change of the picture's size or the sampler's settings. */
void pipeline_follow(struct pipeline *pipeline, int64_t captured_ns);

/* Chooses lights and poses of the next picture. -EINVAL: no such pose. A pose that cannot be
 * loaded, because its file is damaged or memory is short, is an error only where no other pose can
 * be shown instead; else report.missing names it. */
int pipeline_choose(struct pipeline *pipeline, const struct pipeline_choice *choice,
		    struct fault *fault);

/* A pose that is missing is tried once more with the next choice. */
void pipeline_try_again(struct pipeline *pipeline);

/* Whether the background is looked at, for people, its camera's exposure or noise: then call
 * pipeline_look() before each composite, with the whole upright background and the time at which it
 * was captured. It looks at each frame once. Where there is no light yet, or no object, it does
 * nothing. depth: of the same moment, as people_take_depth() has it; NULL: none. */
bool pipeline_looks(const struct pipeline *pipeline);
void pipeline_look(struct pipeline *pipeline, const struct picture *background,
		   const struct depth_map *depth, int64_t captured_ns);

/* The next frame shows the place without people; all that was learned of it is forgotten. */
void pipeline_learn(struct pipeline *pipeline);
void pipeline_forget(struct pipeline *pipeline);

/* What was learned of the place, as people_save() and people_restore() have it
 * (hal/people/people.h). 0 bytes: nobody is looked for, or the picture is too large. */
size_t pipeline_learned_bytes(const struct pipeline *pipeline);
size_t pipeline_learned_save(const struct pipeline *pipeline, void *to, size_t done);
int pipeline_learned_restore(struct pipeline *pipeline, const void *from, size_t bytes,
			     struct fault *fault);

/* Writes the composite, BGRX of the basis's size. -EINVAL: the background has another size. */
int pipeline_composite(struct pipeline *pipeline, const struct backdrop *background, uint8_t *out,
		       size_t out_stride, struct fault *fault);

/* Computes the composite in double precision, of the exact layer where the basis was opened with
 * it: out[height][width][3], R G B code values 0..255, not rounded. Slow. */
int pipeline_reference(struct pipeline *pipeline, const struct picture *background, double *out,
		       struct fault *fault);

struct pipeline_report pipeline_report(const struct pipeline *pipeline);

/* Says why report.missing cannot be loaded. */
const char *pipeline_trouble(const struct pipeline *pipeline);

/* Whether pipeline_recover() has a patch of ground to look at. */
bool pipeline_has_patch(const struct pipeline *pipeline);

/* The following are the pipeline's own, and valid until its next change. */

/* Its threads. */
struct pool *pipeline_pool(const struct pipeline *pipeline);

/* The dome of the basis. */
const struct dome *pipeline_dome(const struct pipeline *pipeline);

/* The lens, for the size of the fisheye's last picture. */
const struct fisheye *pipeline_lens(const struct pipeline *pipeline);

/* [basis lights]: whether each light is in use. */
const bool *pipeline_used(const struct pipeline *pipeline);

/* [basis lights]: radiance of each light, measured, recovered and filtered. */
const float (*pipeline_radiance(const struct pipeline *pipeline))[3];

#endif
