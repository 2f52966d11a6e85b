/* SPDX-License-Identifier: MIT */
/*
 * The compositor turns N light colours and a basis into the finished picture. In each channel:
 *
 *     O     = gain * sum_i t_i L_i                          (T blocks, premultiplied by coverage)
 *     ratio = 1 - sum_i v_i u_i L_i / (sum_i u_i L_i + e)   (V blocks)
 *     ratio = 1 - sum_i d_i L_i / (sum_i u_i L_i + e)       (D and U blocks)
 *     out   = O + min(max(ratio, 0), COMPOSITOR_RATIO_MAX)
 *                 * ((1 - coverage) * B + transmission * B')
 *                                                           (linear light, clipped to 1, encoded)
 *     e     = 2^-20 * sum_i u_i
 *
 * B is the background, B' the background seen through the object (struct basis_glass). L_i is the
 * radiance of light i if it is used, plus what the threshold mode returns of the dropped lights
 * (light/selection.h). Lamps at places add light that depends on the pixel (near/near_sky.h), to L
 * and to u. e is light below any camera's black: as all light fades to 0 the ratio goes
 * to 1 without a jump. hal/GLOSSARY.md lists the symbols.
 *
 * compositor_run() sums in integers: README.md names every Q format and proves that nothing
 * overflows. compositor_reference() computes the same formula in double precision with the exact
 * transfer function; the integer one is measured against it.
 */
#ifndef INLAY_HAL_COMPOSITOR_COMPOSITOR_H
#define INLAY_HAL_COMPOSITOR_COMPOSITOR_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/base/pool.h"
#include "hal/basis/basis.h"
#include "hal/colour/transfer.h"
#include "hal/compositor/light/selection.h"
#include "hal/compositor/live/grain.h"
#include "hal/compositor/live/veil.h"
#include "hal/frame/view.h"
#include "hal/lights/lamps.h"

#define COMPOSITOR_RATIO_MAX 16.0
#define COMPOSITOR_GAIN_MAX 64.0

enum compositor_mode {
	COMPOSITOR_FAST,  /* the shown layer; columns below the cut of their block are left out */
	COMPOSITOR_EXACT, /* the exact layer, which must have been opened: every column */
	COMPOSITOR_MODE_COUNT
};

extern const char *const compositor_mode_names[]; /* "fast", "exact", NULL */

struct compositor_settings {
	enum compositor_mode mode;
	struct transfer_curve background; /* transfer function of the background's code values */
	struct transfer_curve output;
	double gain;		   /* 0..COMPOSITOR_GAIN_MAX */
	bool object;		   /* false: the background alone, by the same transfer functions */
	const struct veil *veil;   /* borrowed: people before the object; NULL: nobody */
	const struct grain *grain; /* borrowed: noise for the object; NULL: none */
	/* Borrowed, [height] of R, G, B: what O of each row is multiplied by (live/lit_rows.h);
	 * NULL: 1. */
	const int32_t (*rows)[3];
};

struct compositor;

struct compositor_options {
	struct pool *pool;  /* NULL: the calling thread does all */
	const char *kernel; /* NULL or "auto": the fastest on this processor (kernels.h) */
	/* Lamps at places, whose light light_selection.lamp has; copied. NULL: none. They are
	 * left out of a basis that does not know its places (compositor_lamps()). */
	const struct lamps *lamps;
};

/* The basis must outlive the compositor. -ENOTSUP: no such kernel on this processor; -ENOMEM;
 * -EINVAL: with lamps, the basis's lights are no dome's or its camera is none. */
int compositor_create(struct compositor **compositor, const struct basis *basis,
		      const struct compositor_options *options, struct fault *fault);

/* Number of lamps at places that count; 0 where the basis does not know its places. */
int compositor_lamps(const struct compositor *compositor);

const char *compositor_kernel(const struct compositor *compositor); /* name of the one in use */

/* Whether compositor_create() accepts a kernel of this name. */
bool compositor_has_kernel(const char *name);

/* Settings for the next frames. */
void compositor_set(struct compositor *compositor, const struct compositor_settings *settings);

/*
 * The background: a picture in memory, or a function that makes a rectangle of it on demand, so
 * that each pixel is touched once. Several threads call make(), once for each part in a frame;
 * twice for parts that are seen through the object.
 */
struct backdrop {
	int width, height;
	struct picture picture; /* used if make is NULL */
	/* Writes the rectangle as upright BGRX with X = 255, and nothing beside it: out may be the
	 * screen. Rectangles begin at multiples of BASIS_TILE. A pixel must not depend on the
	 * rectangle that contains it. */
	void (*make)(const void *context, int x, int y, int width, int height, uint8_t *out,
		     size_t out_stride);
	const void *context;
};

struct backdrop backdrop_of(const struct picture *picture);

/* Loads a pose and plans its blocks; frees the plans of poses that left memory. While the pose
 * stays in memory, compositor_run() of it needs no memory. Errors of basis_pose_load(), -ENOMEM. */
int compositor_take_pose(struct compositor *compositor, int pose, struct fault *fault);

/*
 * Writes a BGRX picture of the basis's size; the background has the same size. out must not overlap
 * it; each pixel of out is written once and never read. Allocates nothing, unless the pose was not
 * in memory in the frame before (compositor_take_pose()), or is the first that mirrors a sky
 * without lights->mirror. Divides the work among the pool's threads
 * by the times of frames before. -EINVAL: another size, or pose out of range; -ENODATA: exact mode
 * without an exact layer; -ENOMEM, -EBADMSG: the pose cannot be loaded.
 */
int compositor_run(struct compositor *compositor, int pose, const struct light_selection *lights,
		   const struct backdrop *background, uint8_t *out, size_t out_stride);

/* Statistics of the last frame. */
struct compositor_frame {
	uint64_t basis_bytes; /* read of the basis: patterns, coefficients, columns */
	int columns;	      /* used, over all blocks */
	int columns_left_out; /* below the cut */
};

struct compositor_frame compositor_last(const struct compositor *compositor);

void compositor_destroy(struct compositor *compositor);

/*
 * Computes the frame in double precision, without settings->grain, from the layer that
 * settings->mode names, with every column, and lights->lamps. out[height][width][3] gets R, G, B as
 * encoded values
 * 0..255, not rounded. background has the basis's size. Slow; for tests, reports and `--mode
 * reference`. -EINVAL, -ENODATA, -ENOMEM and -EBADMSG as compositor_run().
 */
int compositor_reference(const struct basis *basis, int pose,
			 const struct compositor_settings *settings,
			 const struct light_selection *lights, const struct picture *background,
			 double *out);

#endif
