/* SPDX-License-Identifier: MIT */
/*
 * Processor time of a bake by stage, found by sampling.
 *
 * Each thread that works keeps its stage in a variable of its own, which profile_enter() sets. A
 * thread of the profile reads these every millisecond. The processor time of each thread, which is
 * exact, is shared out by how often each stage was read:
 *
 *     seconds[stage] = sum over threads of (processor time * samples in stage / samples)
 *
 * A stage may be entered for every ray, as that is one store; the error of a stage that takes a
 * tenth of a minute of processor time is about 1 %.
 */
#ifndef INLAY_BAKE_BASE_PROFILE_H
#define INLAY_BAKE_BASE_PROFILE_H

#include <stdatomic.h>
#include <stddef.h>

enum profile_stage {
	PROFILE_OTHER,	 /* what no stage below names */
	PROFILE_CAMERA,	 /* camera rays and what they see through glass */
	PROFILE_CELLS,	 /* shadow rays from first surfaces to the cells */
	PROFILE_PATHS,	 /* paths from there on */
	PROFILE_DEPOSIT, /* adding light to a tile's rows */
	PROFILE_FILTER,	 /* filter of the bounced light, noise estimates */
	PROFILE_LIMITS,	 /* the encoder's exposures, and the limits of every residual */
	PROFILE_BASIS,	 /* low-rank bases */
	PROFILE_COLUMNS, /* residual columns */
	PROFILE_SKIES,	 /* errors of plans under the ensemble's skies */
	PROFILE_CHECK,	 /* errors of the blocks as a reader decodes them */
	PROFILE_WRITE,	 /* blocks, packing, the file */
	PROFILE_STAGES
};

/* One word for each stage, as the provenance and the table have it. */
extern const char *const profile_stage_names[PROFILE_STAGES];

/* The stage of this thread. Only profile_enter() and the profile itself touch it. */
extern _Thread_local atomic_int profile_now;

/* Enters a stage. Returns the one before, to go back to. */
static inline enum profile_stage profile_enter(enum profile_stage stage)
{
	const int before = atomic_load_explicit(&profile_now, memory_order_relaxed);

	atomic_store_explicit(&profile_now, stage, memory_order_relaxed);
	return (enum profile_stage)before;
}

struct profile;

/* Starts sampling threads, none at first. -ENOMEM, -EAGAIN. */
int profile_begin(struct profile **profile, int threads_max);

/* Watches the calling thread as number 0..threads_max - 1, once; it has to live until
 * profile_end(). NULL is harmless. */
void profile_watch(struct profile *profile, int number);

/* Stops, and sets the processor time of each stage so far, in seconds. NULL is harmless. */
void profile_end(struct profile *profile, double seconds[PROFILE_STAGES]);

#endif
