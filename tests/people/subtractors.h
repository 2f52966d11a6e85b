/* SPDX-License-Identifier: MIT */
/* OpenCV's background subtractors, for comparison. */
#ifndef INLAY_TESTS_PEOPLE_SUBTRACTORS_H
#define INLAY_TESTS_PEOPLE_SUBTRACTORS_H

#include <stdint.h>

enum { SUBTRACTORS = 2 }; /* MOG2 and KNN, as they come */

extern const char *const subtractor_names[SUBTRACTORS];

#ifdef __cplusplus
extern "C" {
#endif

struct subtractors;

/* NULL: no memory. */
struct subtractors *subtractors_create(int width, int height);

/* Takes a frame, bgrx[height][width][4], and writes who is in front of the background to
 * mask[method][height][width]: 255; a shadow counts as background. Each learns as it likes. */
void subtractors_look(struct subtractors *all, const uint8_t *bgrx,
		      uint8_t *const mask[SUBTRACTORS]);
void subtractors_destroy(struct subtractors *all);

#ifdef __cplusplus
}
#endif

#endif
