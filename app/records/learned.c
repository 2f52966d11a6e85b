/* SPDX-License-Identifier: MIT */
#include "app/records/records.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/base/input.h"
#include "hal/base/log.h"

#define FIRST_INTERVALS 4
#define INTERVALS 360
#define LEARNED_LEAST 0.5 /* share of the place, below which nothing is written */

struct learned {
	struct keeper *keeper;
	char path[PATH_MAX]; /* empty: nothing is kept */
	int64_t interval_ns;
	int64_t due_ns;	    /* when the next copy begins */
	uint8_t *copy;	    /* that is being made; NULL: none is */
	size_t bytes, done; /* of it */
	bool short_said;    /* it was logged that memory is short */
};

/* ---- when ---- */

static void take_settings(struct learned *l, const struct config_state *settings)
{
	l->interval_ns = (int64_t)(settings->interval_s * (double)NS_PER_S);
	l->path[0] = '\0';
	if (*settings->file)
		snprintf(l->path, sizeof(l->path), "%s.place", settings->file);
}

static int64_t after_intervals(const struct learned *l, int count)
{
	const int64_t wait_ns = count * l->interval_ns;

	return clock_now_ns() + (wait_ns < NS_PER_S ? NS_PER_S : wait_ns);
}

static void abandon_copy(struct learned *l)
{
	free(l->copy);
	l->copy = NULL;
}

int learned_create(struct learned **out, struct keeper *keeper, const struct config_state *settings)
{
	struct learned *l = calloc(1, sizeof(*l));

	if (!l)
		return -ENOMEM;
	l->keeper = keeper;
	take_settings(l, settings);
	l->due_ns = after_intervals(l, FIRST_INTERVALS);
	*out = l;
	return 0;
}

void learned_move(struct learned *l, const struct config_state *settings)
{
	if (!l)
		return;
	take_settings(l, settings);
	l->due_ns = after_intervals(l, FIRST_INTERVALS);
}

void learned_soon(struct learned *l)
{
	if (l)
		l->due_ns = after_intervals(l, FIRST_INTERVALS);
}

void learned_forget(struct learned *l)
{
	if (!l)
		return;
	abandon_copy(l);
	l->due_ns = after_intervals(l, FIRST_INTERVALS);
	if (*l->path)
		keeper_put(l->keeper, KEEPER_PLACE, l->path, NULL, 0);
}

/* ---- reading ---- */

/* Reads a file of exactly that many bytes, which the caller frees. One of another length is read as
 * far, so that its header tells what it is. */
static int read_file(const char *path, size_t bytes, uint8_t **out, size_t *count,
		     struct fault *fault)
{
	FILE *stream;
	int err = input_stream(path, &stream, fault);

	if (err)
		return err;
	*out = malloc(bytes + 1);
	if (!*out)
		err = fault_say(fault, -ENOMEM, "%s: not enough memory to read it", path);
	if (!err)
		*count = fread(*out, 1, bytes + 1, stream);
	if (!err && ferror(stream))
		err = fault_say(fault, -EIO, "%s: cannot be read", path);
	fclose(stream);
	return err;
}

static int restore_file(const char *path, struct pipeline *pipeline, struct fault *fault)
{
	struct fault reason = {.text = ""};
	uint8_t *bytes = NULL;
	size_t count = 0;
	int err = read_file(path, pipeline_learned_bytes(pipeline), &bytes, &count, fault);

	if (!err) {
		err = pipeline_learned_restore(pipeline, bytes, count, &reason);
		if (err)
			fault_say(fault, err, "%s: %s", path, reason.text);
	}
	free(bytes);
	return err;
}

void learned_restore(struct learned *l, struct pipeline *pipeline)
{
	struct fault fault = {.text = ""};
	int err;

	if (!l || pipeline_report(pipeline).people.begun)
		return;
	abandon_copy(l); /* perhaps of a pipeline that is no more */
	l->due_ns = after_intervals(l, FIRST_INTERVALS);
	if (!*l->path || !pipeline_learned_bytes(pipeline))
		return;
	err = restore_file(l->path, pipeline, &fault);
	if (!err) {
		l->due_ns = after_intervals(l, INTERVALS);
		log_info("people: the place is known from %s", l->path);
	} else if (err != -ENOENT) {
		log_warning("people: %s; the place is learned anew", fault.text);
	}
}

/* ---- writing ---- */

/* Whether there is something that is worth to be kept. */
static bool is_worth(const struct learned *l, const struct pipeline *pipeline)
{
	const struct pipeline_people_seen people = pipeline_report(pipeline).people;

	return *l->path && people.on && people.begun && people.learned >= LEARNED_LEAST;
}

static void begin_copy(struct learned *l, const struct pipeline *pipeline)
{
	l->due_ns = after_intervals(l, INTERVALS);
	l->done = 0;
	l->bytes = pipeline_learned_bytes(pipeline);
	if (!l->bytes)
		return;
	l->copy = malloc(l->bytes);
	if (!l->copy && !l->short_said)
		log_warning("people: not enough memory to keep what was learned of the place");
	l->short_said = !l->copy;
}

static void copy_some(struct learned *l, const struct pipeline *pipeline)
{
	l->done = pipeline_learned_save(pipeline, l->copy, l->done);
	if (l->done < l->bytes)
		return;
	keeper_put(l->keeper, KEEPER_PLACE, l->path, l->copy, l->bytes);
	l->copy = NULL;
}

void learned_keep(struct learned *l, const struct pipeline *pipeline)
{
	if (!l)
		return;
	if (l->copy)
		copy_some(l, pipeline);
	else if (clock_now_ns() >= l->due_ns && is_worth(l, pipeline) &&
		 keeper_look(l->keeper, KEEPER_PLACE) != KEEPER_BUSY)
		begin_copy(l, pipeline);
}

void learned_destroy(struct learned *l, const struct pipeline *pipeline)
{
	if (!l)
		return;
	abandon_copy(l);
	if (pipeline && is_worth(l, pipeline)) {
		begin_copy(l, pipeline);
		while (l->copy)
			copy_some(l, pipeline);
	}
	free(l);
}
