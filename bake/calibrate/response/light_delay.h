/* SPDX-License-Identifier: MIT */
/*
 * The delay between changing an exposure control and seeing the effect, from alternating exposures
 * and the brightness of each frame. The delay in frames is the shift with the largest correlation
 * between control and brightness; the delay in time is measured for each change: until the
 * brightness has passed half of its step.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_DELAY_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_DELAY_H

#include "bake/calibrate/estimate/verdict.h"
#include "hal/base/fault.h"

#define LIGHT_DELAY_FRAMES_MAX 30 /* longest delay searched */

struct light_record {
	double *time_ms; /* [frames], ascending: time of capture */
	double *level;	 /* [frames]: mean code value, or any other brightness */
	int frames;
	double *change_ms; /* [changes], ascending: changes to the other exposure and back */
	int changes;
	int room_frames, room_changes; /* private: allocated */
};

struct light_delay {
	int frames;	    /* from a change to the first frame that shows it; 0: the next one */
	double correlation; /* -1..1, at that delay */
	double time_ms, deviation_ms; /* mean and standard deviation over the changes */
	double shortest_ms, longest_ms;
	int seen; /* changes that were detected */
	struct verdict verdict;
};

/* Append a frame or a change. -ENOMEM. */
int light_record_frame(struct light_record *record, double time_ms, double level);
int light_record_change(struct light_record *record, double time_ms);
void light_record_free(struct light_record *record); /* idempotent; zeroed is fine */

/* Reads lines `time_ms level` of frames and `change time_ms` of changes, each ascending; blank
 * lines and what follows # are ignored. -EINVAL with file and line; -ENOENT...; -ENOMEM. */
int light_record_read(struct light_record *record, const char *path, struct fault *fault);

/* Finds the delay. -EINVAL: fewer than two changes or eight frames; -ENOMEM. */
int light_delay_find(struct light_delay *found, const struct light_record *record,
		     struct fault *fault);

#endif
