/* SPDX-License-Identifier: MIT */
/* A room's frames in a file, with the truth and what others made of them: render writes it once,
 * and judge reads it as often as somebody changes hal/people. */
#ifndef INLAY_TESTS_PEOPLE_RECORDING_H
#define INLAY_TESTS_PEOPLE_RECORDING_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define RECORDING_MAGIC UINT64_C(0x31304d4f4f52) /* "ROOM01" */
/* Who covers most of a pixel: his number, from 1, and whether he is nearer than the object. */
#define TRUTH_WALKER 0x0f
#define TRUTH_BEFORE 0x80

struct recording_head {
	uint64_t magic;
	int32_t room, width, height, lights, tiles;
	int32_t looked; /* pixels in tiles in which the object changes a pixel by a level */
};

struct recording_moment {
	int64_t captured_ns;
	int32_t walkers;  /* in the room */
	int32_t switched; /* a lamp was, since the frame before */
	float exposure;	  /* of green, the first frame's is 1 */
	float pad;
};

struct recording {
	FILE *file;
	struct recording_head head;
	uint8_t *touched; /* [tiles] */
	int *looked;	  /* [looked]: pixel numbers */
	/* The present frame. */
	struct recording_moment moment;
	float (*light)[3];
	uint8_t *bgr; /* [h][w][3] */
	/* [looked], from the frame LEARNING on: a share of 255, TRUTH_*, a bit for each method. */
	uint8_t *alpha, *who, *others;
};

/* Makes room for what a head describes, touched and looked included. False: no memory. */
bool recording_make_room(struct recording *recording);
/* False: the file is missing or was not written to its end. */
bool recording_open(struct recording *recording, const char *path);
bool recording_read(struct recording *recording, int frame);
bool recording_write_head(struct recording *recording, const char *path);
bool recording_write(struct recording *recording, int frame);
/* False: something could not be written. */
bool recording_close(struct recording *recording);

#endif
