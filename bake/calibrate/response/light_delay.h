/* SPDX-License-Identifier: MIT */
/*
 * The delay between changing an exposure control and seeing it: two exposures in turn, and the
 * brightness of each frame. The delay in frames is the shift at which the brightness follows the
 * control best (correlation); that in time is of each change alone: when the brightness has passed
 * half of its way.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_DELAY_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_DELAY_H

#include "bake/calibrate/estimate/verdict.h"
#include "hal/base/fault.h"

#define LIGHT_DELAY_FRAMES_MAX 30 /* the longest that is looked for */

struct light_record {
	double *time_ms; /* [frames], ascending: of capture */
	double *level;	 /* [frames]: mean code value, or any other brightness */
	int frames;
	double *change_ms; /* [changes], ascending: to the other exposure and back */
	int changes;
	int room_frames, room_changes; /* private */
};

struct light_delay {
	int frames;	    /* from a change to the first frame that shows it: 0: the next one */
	double correlation; /* -1..1, at that delay */
	double time_ms, deviation_ms; /* mean over the changes, and how they spread */
	double shortest_ms, longest_ms;
	int seen; /* changes that were */
	struct verdict verdict;
};

/* -ENOMEM. */
int light_record_frame(struct light_record *record, double time_ms, double level);
int light_record_change(struct light_record *record, double time_ms);
void light_record_free(struct light_record *record); /* idempotent; zeroed is fine */

/* Lines `time_ms level` of frames and `change time_ms` of changes, each ascending; blank lines and
 * what follows # are passed over. -EINVAL with file and line; -ENOENT...; -ENOMEM. */
int light_record_read(struct light_record *record, const char *path, struct fault *fault);

/* -EINVAL: fewer than two changes or eight frames; -ENOMEM. */
int light_delay_find(struct light_delay *found, const struct light_record *record,
		     struct fault *fault);

#endif
