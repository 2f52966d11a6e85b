/* SPDX-License-Identifier: MIT */
#include "bake/base/profile.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PERIOD_NS 1000000

const char *const profile_stage_names[PROFILE_STAGES] = {
	"other",  "camera", "cells",   "paths", "deposit", "filter",
	"limits", "basis",  "columns", "skies", "check",   "write",
};

_Thread_local atomic_int profile_now;

struct profile_thread {
	atomic_int *_Atomic now; /* NULL: not watched yet */
	clockid_t clock;
	double begun_s; /* processor time when watching began */
	uint64_t samples[PROFILE_STAGES];
};

struct profile {
	pthread_t sampler;
	atomic_bool ending;
	int count;
	struct profile_thread thread[];
};

static double profile_clock_s(clockid_t clock)
{
	struct timespec t = {0};

	clock_gettime(clock, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *profile_sample(void *context)
{
	const struct timespec period = {.tv_nsec = PERIOD_NS};
	struct profile *p = context;

	while (!atomic_load_explicit(&p->ending, memory_order_relaxed)) {
		nanosleep(&period, NULL);
		for (int k = 0; k < p->count; k++) {
			const atomic_int *now = p->thread[k].now;

			if (now)
				p->thread[k]
					.samples[atomic_load_explicit(now, memory_order_relaxed)]++;
		}
	}
	return NULL;
}

int profile_begin(struct profile **profile, int threads_max)
{
	struct profile *p = calloc(1, sizeof(*p) + (size_t)threads_max * sizeof(*p->thread));
	int err;

	*profile = NULL;
	if (!p)
		return -ENOMEM;
	p->count = threads_max;
	err = pthread_create(&p->sampler, NULL, profile_sample, p);
	if (err) {
		free(p);
		return -err;
	}
	*profile = p;
	return 0;
}

void profile_watch(struct profile *profile, int number)
{
	struct profile_thread *thread;

	if (!profile || profile->thread[number].now)
		return;
	thread = &profile->thread[number];
	pthread_getcpuclockid(pthread_self(), &thread->clock);
	thread->begun_s = profile_clock_s(thread->clock);
	thread->now = &profile_now;
}

void profile_end(struct profile *profile, double seconds[PROFILE_STAGES])
{
	if (!profile)
		return;
	memset(seconds, 0, PROFILE_STAGES * sizeof(*seconds));
	atomic_store(&profile->ending, true);
	pthread_join(profile->sampler, NULL);
	for (int k = 0; k < profile->count; k++) {
		const struct profile_thread *thread = &profile->thread[k];
		uint64_t samples = 0;
		double own_s;

		if (!thread->now)
			continue;
		own_s = profile_clock_s(thread->clock) - thread->begun_s;
		for (int stage = 0; stage < PROFILE_STAGES; stage++)
			samples += thread->samples[stage];
		for (int stage = 0; stage < PROFILE_STAGES && samples; stage++)
			seconds[stage] += own_s * (double)thread->samples[stage] / (double)samples;
	}
	free(profile);
}
