/* SPDX-License-Identifier: MIT */
/*
 * The compositor: N light colours and a basis to the finished picture.
 *
 *     O     = gain * sum_i t_i L_i                          (T blocks, premultiplied by coverage)
 *     ratio = 1 - sum_i v_i u_i L_i / (sum_i u_i L_i + e)   (V blocks)
 *     ratio = 1 - sum_i d_i L_i / (sum_i u_i L_i + e)       (D and U blocks)
 *     out   = O + max(ratio, 0) * ((1 - coverage) * B + transmission * B')
 *                                                           (linear light, clipped to 1, encoded)
 *
 * per channel; L_i of used lights, plus in ambient mode one uniform radiance over all lights that
 * stands for the dropped ones, or in mode harmonics one that varies smoothly over the sky. e =
 * 2^-20 * sum_i u_i: light below any camera's black; as all light goes out the ratio goes to 1
 * without a jump, 0/0 included. ratio is capped at COMPOSITOR_RATIO_MAX.
 * B' is the background as it is seen through the object (struct basis_glass).
 *
 * compositor_run() sums in integers: README.md names every Q format and proves that nothing
 * overflows. compositor_reference() is the same formula in double precision with the exact transfer
 * function; it is what the integer one is measured against.
 */
#ifndef INLAY_HAL_COMPOSITOR_COMPOSITOR_H
#define INLAY_HAL_COMPOSITOR_COMPOSITOR_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/base/pool.h"
#include "hal/basis/basis.h"
#include "hal/colour/transfer.h"
#include "hal/compositor/light/selection.h"
#include "hal/frame/view.h"

#define COMPOSITOR_RATIO_MAX 16.0
#define COMPOSITOR_GAIN_MAX 64.0

enum compositor_mode {
	COMPOSITOR_FAST,  /* the shown layer; columns below the basis's column_cut are left out */
	COMPOSITOR_EXACT, /* the exact layer (basis_open() with it): every light, every byte */
	COMPOSITOR_MODE_COUNT
};

extern const char *const compositor_mode_names[]; /* "fast", "exact", NULL */

/* Whether a frame in exact mode starts from the sums of the one before it, and adds only what has
 * changed. Both give the same bits. In fast mode none does, as it would cost more than it saves. */
enum compositor_reuse {
	REUSE_AUTO, /* whichever has less to read; sums are kept while few lights change */
	REUSE_NEVER,
	REUSE_ALWAYS, /* where there is an exact frame before it of the same pose */
	REUSE_COUNT
};

extern const char *const compositor_reuse_names[]; /* "auto", "never", "always", NULL */

struct compositor_settings {
	enum compositor_mode mode;
	enum compositor_reuse reuse;
	struct transfer_curve background; /* of the background picture's code values */
	struct transfer_curve output;
	double gain; /* 0..COMPOSITOR_GAIN_MAX */
	bool object; /* false: the background alone, copied through the same tables */
};

struct compositor;

struct compositor_options {
	struct pool *pool;  /* NULL: the calling thread only */
	const char *kernel; /* NULL or "auto": the fastest that the processor has (kernels.h) */
};

/* The basis must outlive the compositor. -ENOTSUP: no such kernel here, -ENOMEM. */
int compositor_create(struct compositor **compositor, const struct basis *basis,
		      const struct compositor_options *options, struct fault *fault);

const char *compositor_kernel(const struct compositor *compositor); /* the one in use */

/* Whether compositor_create() would find a kernel of that name. */
bool compositor_has_kernel(const char *name);

/* From the next frame on. Allocates room for sums when they may first be kept and the file has
 * blocks whose sums are worth it; where there is no memory for it nothing is reused. */
void compositor_set(struct compositor *compositor, const struct compositor_settings *settings);

/*
 * The background: a picture in memory or, so that each of its pixels is touched once, somebody who
 * makes a part of it when it is needed (and called for each part once a frame, or twice where it is
 * seen through the object, by several threads).
 */
struct backdrop {
	int width, height;
	struct picture picture; /* where make is NULL */
	/* Writes the rectangle as upright BGRX, X being 255, and nothing beside it: out may be the
	 * screen. A pixel must not depend on which rectangle it is asked for in; those begin at
	 * multiples of BASIS_TILE. */
	void (*make)(const void *context, int x, int y, int width, int height, uint8_t *out,
		     size_t out_stride);
	const void *context;
};

struct backdrop backdrop_of(const struct picture *picture);

/* Sees to it that a pose is in memory, with what is found out about its blocks; forgets that of
 * poses which are not any more. As long as the pose stays in memory, compositor_run() of it cannot
 * fail for want of it. What basis_pose_load() returns, -ENOMEM. */
int compositor_take_pose(struct compositor *compositor, int pose, struct fault *fault);

/*
 * Writes a BGRX picture of the basis's size. background has that size. out must not overlap it; it
 * is written once, in whole cache lines where it can be, and never read. Nothing is allocated, but
 * for a pose that was not in memory in the frame before (compositor_take_pose()). Work is divided
 * among the pool's threads by what its parts took before. -EINVAL: another size, pose out of range;
 * -ENODATA: exact mode without an exact layer; -ENOMEM, -EBADMSG: of a pose to be loaded.
 */
int compositor_run(struct compositor *compositor, int pose, const struct light_selection *lights,
		   const struct backdrop *background, uint8_t *out, size_t out_stride);

/* What the last frame took. */
struct compositor_frame {
	uint64_t basis_bytes; /* of the basis read: patterns, coefficients, columns */
	int columns;	      /* of single lights used, over all blocks */
	int columns_left_out; /* by the cut */
	bool reused;	      /* the sums before it were */
};

struct compositor_frame compositor_last(const struct compositor *compositor);

void compositor_destroy(struct compositor *compositor);

/*
 * Double precision, of the layer that settings->mode names, every column used:
 * out[height][width][3] gets R, G, B as encoded values in 0..255, not rounded. background has the
 * basis's size. Slow; for tests, reports and `--mode reference`.
 */
int compositor_reference(const struct basis *basis, int pose,
			 const struct compositor_settings *settings,
			 const struct light_selection *lights, const struct picture *background,
			 double *out);

#endif
