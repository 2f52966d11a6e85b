/* SPDX-License-Identifier: MIT */
#include "app/records/records.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/clock.h"
#include "hal/base/input.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/people/people.h"

#define FIRST_INTERVALS 4
#define INTERVALS 360
#define LEARNED_LEAST 0.5 /* share of the place, below which nothing is written */

struct learned {
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	/* Under the lock: */
	char path[PATH_MAX]; /* empty: nothing is kept */
	uint8_t *ready;	     /* to be written, and freed by the thread; NULL: nothing is */
	size_t ready_bytes;
	bool drop; /* the file is to be removed, before anything is written */
	bool leave;
	/* For the callers' thread alone: */
	int64_t interval_ns;
	int64_t due_ns;	    /* when the next copy begins */
	uint8_t *copy;	    /* that is being made; NULL: none is */
	size_t bytes, done; /* of it */
	bool short_said;    /* it was logged that memory is short */
};

/* ---- the thread that writes ---- */

static int write_file(const char *path, const uint8_t *bytes, size_t count, struct fault *fault)
{
	struct output out;
	int err = output_open(&out, path, fault);

	if (err)
		return err;
	fwrite(bytes, 1, count, out.stream); /* output_commit() tells of failures */
	return output_commit(&out, fault);
}

/* Called without the lock. *said: what was logged last. */
static void write_learned(const char *path, uint8_t *bytes, size_t count, struct fault *said)
{
	struct fault fault = {.text = ""};
	int err;

	people_seal(bytes, count);
	err = write_file(path, bytes, count, &fault);
	if (err && strcmp(said->text, fault.text) != 0)
		log_warning("people: %s; what was learned of the place is not kept", fault.text);
	if (!err && *said->text)
		log_info("people: %s is written again", path);
	*said = err ? fault : (struct fault){.text = ""};
}

static void drop_file(const char *path)
{
	if (*path && unlink(path) < 0 && errno != ENOENT)
		log_warning("people: %s: cannot be removed: %s", path, strerror(errno));
}

static void *write_and_drop(void *context)
{
	struct learned *l = context;
	struct fault said = {.text = ""};
	char path[PATH_MAX];

	pthread_mutex_lock(&l->lock);
	while (l->ready || l->drop || !l->leave) {
		const bool drop = l->drop;
		uint8_t *bytes = l->ready;
		const size_t count = l->ready_bytes;

		if (!drop && !bytes) {
			pthread_cond_wait(&l->wake, &l->lock);
			continue;
		}
		l->drop = false;
		if (!drop)
			l->ready = NULL;
		memcpy(path, l->path, sizeof(path));
		pthread_mutex_unlock(&l->lock);
		if (drop) {
			drop_file(path);
		} else {
			write_learned(path, bytes, count, &said);
			free(bytes);
		}
		pthread_mutex_lock(&l->lock);
	}
	pthread_mutex_unlock(&l->lock);
	return NULL;
}

static int start_thread(struct learned *l)
{
	sigset_t all, before;
	int err;

	pthread_mutex_init(&l->lock, NULL); /* these do not fail in glibc */
	pthread_cond_init(&l->wake, NULL);
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	err = -pthread_create(&l->thread, NULL, write_and_drop, l);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return err;
}

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

int learned_create(struct learned **out, const struct config_state *settings)
{
	struct learned *l = calloc(1, sizeof(*l));
	int err;

	if (!l)
		return -ENOMEM;
	take_settings(l, settings);
	l->due_ns = after_intervals(l, FIRST_INTERVALS);
	err = start_thread(l);
	if (err) {
		free(l);
		return err;
	}
	*out = l;
	return 0;
}

void learned_move(struct learned *l, const struct config_state *settings)
{
	if (!l)
		return;
	pthread_mutex_lock(&l->lock);
	take_settings(l, settings);
	pthread_mutex_unlock(&l->lock);
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
	pthread_mutex_lock(&l->lock);
	free(l->ready);
	l->ready = NULL;
	l->drop = true;
	pthread_cond_signal(&l->wake);
	pthread_mutex_unlock(&l->lock);
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

static bool is_writing(struct learned *l)
{
	bool writing;

	pthread_mutex_lock(&l->lock);
	writing = l->ready || l->drop;
	pthread_mutex_unlock(&l->lock);
	return writing;
}

/* Whether there is something that is worth to be kept. */
static bool is_worth(const struct learned *l, const struct pipeline *pipeline)
{
	const struct pipeline_people_seen seen = pipeline_report(pipeline).people;

	return *l->path && seen.on && seen.begun && seen.learned >= LEARNED_LEAST;
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
	pthread_mutex_lock(&l->lock);
	l->ready = l->copy;
	l->ready_bytes = l->bytes;
	pthread_cond_signal(&l->wake);
	pthread_mutex_unlock(&l->lock);
	l->copy = NULL;
}

void learned_keep(struct learned *l, const struct pipeline *pipeline)
{
	if (!l)
		return;
	if (l->copy)
		copy_some(l, pipeline);
	else if (clock_now_ns() >= l->due_ns && is_worth(l, pipeline) && !is_writing(l))
		begin_copy(l, pipeline);
}

void learned_destroy(struct learned *l, const struct pipeline *pipeline)
{
	if (!l)
		return;
	abandon_copy(l);
	if (pipeline && is_worth(l, pipeline)) {
		/* One that is not begun yet is older. */
		pthread_mutex_lock(&l->lock);
		free(l->ready);
		l->ready = NULL;
		pthread_mutex_unlock(&l->lock);
		begin_copy(l, pipeline);
		while (l->copy)
			copy_some(l, pipeline);
	}
	pthread_mutex_lock(&l->lock);
	l->leave = true;
	pthread_cond_signal(&l->wake);
	pthread_mutex_unlock(&l->lock);
	pthread_join(l->thread, NULL);
	pthread_cond_destroy(&l->wake);
	pthread_mutex_destroy(&l->lock);
	free(l);
}
