/* SPDX-License-Identifier: MIT */
#include "app/records/records.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

static const struct ini_key keys[] = {
	{"threshold", INI_LEVEL, offsetof(struct state_values, threshold), .max = 255,
	 .fallback = "0"},
	{"view", INI_CHOICE, offsetof(struct state_values, view), .choices = config_show_names,
	 .fallback = "composite"},
	{"pose", INI_INT, offsetof(struct state_values, pose), .max = 65535, .fallback = "0"},
	INI_KEYS_END};

static void *put_value(void *root, const char *instance)
{
	(void)instance;
	return root;
}

static const struct ini_table tables[] = {{"chosen", .keys = keys, .place = put_value},
					  INI_TABLES_END};

/* ---- reading ---- */

static int take_values(int err, const struct ini_report *report, const struct state_values *read,
		       struct state_values *values, struct fault *fault)
{
	if (err)
		return fault_say(fault, err, "%s", report->first.text);
	*values = *read;
	return 0;
}

int state_read(const char *path, struct state_values *values, struct fault *fault)
{
	struct ini_report report = {.count = 0};
	struct state_values read = *values;
	int err = ini_read(path, tables, &read, &report);

	return take_values(err, &report, &read, values, fault);
}

int state_read_memory(const char *text, size_t bytes, const char *name, struct state_values *values,
		      struct fault *fault)
{
	struct ini_report report = {.count = 0};
	struct state_values read = *values;
	int err = ini_read_memory(text, bytes, name, "", tables, &read, &report);

	return take_values(err, &report, &read, values, fault);
}

/* ---- writing ---- */

struct state {
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	/* Under the lock: */
	struct config_state settings;
	struct state_values wanted;
	bool moved, leave;
	/* For the thread alone: */
	struct state_values kept;
	int64_t next_ns; /* nothing is written before */
	struct fault said;
};

static int write_state(const char *path, const struct state_values *values, struct fault *fault)
{
	struct output out;
	int err = output_open(&out, path, fault);

	if (err)
		return err;
	fputs("; What was chosen last, written by inlay. Without this file the configuration counts.\n"
	      "[chosen]\n",
	      out.stream);
	for (const struct ini_key *key = keys; key->name; key++) {
		char text[INI_TEXT_MAX];

		ini_value_text(key, values, text, sizeof(text));
		fprintf(out.stream, "%s = %s\n", key->name, text);
	}
	return output_commit(&out, fault);
}

/* Called without the lock. */
static void write_now(struct state *state, const struct config_state *settings,
		      const struct state_values *values)
{
	struct fault fault = {.text = ""};
	int err = write_state(settings->file, values, &fault);

	state->kept = *values;
	if (err)
		state->kept.pose =
			-1; /* unlike any wanted values, so that they are written again */
	if (err && strcmp(state->said.text, fault.text) != 0)
		log_warning("state: %s", fault.text);
	if (!err && *state->said.text)
		log_info("state: %s is written again", settings->file);
	state->said = fault;
}

static bool same_values(const struct state_values *a, const struct state_values *b)
{
	return a->threshold.value == b->threshold.value &&
	       a->threshold.percent == b->threshold.percent && a->view == b->view &&
	       a->pose == b->pose;
}

/* Waits until there is something to write and its time has come. False: end the thread. */
static bool state_wait(struct state *state)
{
	for (;;) {
		bool due = *state->settings.file &&
			   (state->moved || !same_values(&state->wanted, &state->kept));
		int64_t wait_ns = state->next_ns - clock_now_ns();
		struct timespec until = {(time_t)(state->next_ns / NS_PER_S),
					 (long)(state->next_ns % NS_PER_S)};

		if (due && (wait_ns <= 0 || state->leave))
			return true;
		if (state->leave)
			return false;
		if (due)
			pthread_cond_timedwait(&state->wake, &state->lock, &until);
		else
			pthread_cond_wait(&state->wake, &state->lock);
	}
}

static void *write_values(void *context)
{
	struct state *state = context;
	bool last = false;

	pthread_mutex_lock(&state->lock);
	while (!last && state_wait(state)) {
		const struct config_state settings = state->settings;
		const struct state_values values = state->wanted;
		int64_t interval_ns = (int64_t)(settings.interval_s * (double)NS_PER_S);

		last = state->leave;
		state->moved = false;
		pthread_mutex_unlock(&state->lock);
		write_now(state, &settings, &values);
		pthread_mutex_lock(&state->lock);
		if (*state->said.text && interval_ns < NS_PER_S)
			interval_ns = NS_PER_S;
		state->next_ns = clock_now_ns() + interval_ns;
	}
	pthread_mutex_unlock(&state->lock);
	return NULL;
}

static int start_writer(struct state *state)
{
	pthread_condattr_t attributes;
	sigset_t all, before;
	int err;

	pthread_mutex_init(&state->lock, NULL); /* these do not fail in glibc */
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_cond_init(&state->wake, &attributes);
	pthread_condattr_destroy(&attributes);
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	err = -pthread_create(&state->thread, NULL, write_values, state);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return err;
}

int state_create(struct state **out, const struct config_state *settings,
		 const struct state_values *now)
{
	struct state *state = calloc(1, sizeof(*state));
	int err;

	if (!state)
		return -ENOMEM;
	state->settings = *settings;
	state->wanted = state->kept = *now;
	err = start_writer(state);
	if (err) {
		free(state);
		return err;
	}
	*out = state;
	return 0;
}

void state_move(struct state *state, const struct config_state *settings)
{
	if (!state)
		return;
	pthread_mutex_lock(&state->lock);
	state->moved |= strcmp(state->settings.file, settings->file) != 0;
	state->settings = *settings;
	state->next_ns = 0;
	pthread_cond_signal(&state->wake);
	pthread_mutex_unlock(&state->lock);
}

void state_keep(struct state *state, const struct state_values *values)
{
	if (!state)
		return;
	pthread_mutex_lock(&state->lock);
	state->wanted = *values;
	pthread_cond_signal(&state->wake);
	pthread_mutex_unlock(&state->lock);
}

void state_destroy(struct state *state)
{
	if (!state)
		return;
	pthread_mutex_lock(&state->lock);
	state->leave = true;
	pthread_cond_signal(&state->wake);
	pthread_mutex_unlock(&state->lock);
	pthread_join(state->thread, NULL);
	pthread_cond_destroy(&state->wake);
	pthread_mutex_destroy(&state->lock);
	free(state);
}
