/* SPDX-License-Identifier: MIT */
/* A drawn room's frames, and hal/people that looks at them. Who cannot go on ends the program with
 * a sentence. */
#ifndef INLAY_TESTS_PEOPLE_JUDGED_H
#define INLAY_TESTS_PEOPLE_JUDGED_H

#include "hal/basis/basis.h"
#include "hal/people/people.h"
#include "tests/people/recording.h"

struct judged {
	struct recording recording;
	struct basis basis;
	struct dome dome;
	struct tsai_camera camera;
	struct people *people;
	int pixels, object; /* pixels that the object covers by half */
	uint8_t *bgrx;
	uint8_t *tile_near; /* [tiles]: somebody is in it, or in one beside it */
	double look_s;
	int looks;
};

void judged_die(const char *what) __attribute__((noreturn));
void *judged_make(size_t bytes); /* zeroed */
/* FOLDER has N.room and N.inlay. */
void judged_open(struct judged *judged, const char *folder, int room);
void judged_close(struct judged *judged);
/* Takes the next frame of the file, moved to the right by some pixels. */
void judged_read(struct judged *judged, int frame, int moved_px);
void judged_look(struct judged *judged, int64_t captured_ns);

#endif
