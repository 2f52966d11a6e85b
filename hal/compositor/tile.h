/* One tile of the picture, composited. Private to hal/compositor. */
#ifndef INLAY_HAL_COMPOSITOR_TILE_H
#define INLAY_HAL_COMPOSITOR_TILE_H

#include <stdbool.h>

#include "hal/compositor/compositor.h"
#include "hal/compositor/weights.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

/* One frame, as all workers read it. */
struct tile_frame {
	const struct basis *basis;
	int pose;
	const struct weights(*object);	   /* [3] */
	const struct weights(*receiver);   /* [3] */
	const struct weights (*ground)[3]; /* [grounds][3] */
	const uint16_t *decode;		   /* [256]: the background's, U16 linear */
	const uint8_t *encode;		   /* [65536] */
	const uint8_t *recode;		   /* [256]: encode[decode[code]] */
	bool same_codes;		   /* recode changes nothing */
	struct picture background;
	uint8_t *out;
	size_t out_stride;
};

/* What one worker needs; each has its own. */
struct tile_scratch {
	struct segments segments[3];
	int64_t sum[TILE_PIXELS][3];
	int64_t own_sum[TILE_PIXELS][3]; /* of U */
	int32_t object[TILE_PIXELS][3];	 /* O, 65535 = 1.0 */
	int32_t ratio[TILE_PIXELS][3];	 /* Q16 */
};

struct tile_scratch *tile_scratch_create(int lights);
void tile_scratch_destroy(struct tile_scratch *scratch); /* NULL is harmless */

/* The object and its shadow over the background. */
void tile_composite(const struct tile_frame *frame, const struct basis_tile *tile,
		    struct tile_scratch *scratch);

/* The background alone. */
void tile_copy(const struct tile_frame *frame, const struct basis_tile *tile);

#endif
