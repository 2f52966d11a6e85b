/* SPDX-License-Identifier: MIT */
#include "app/records/records.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"

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
	struct keeper *keeper;
	struct config_state settings;
	struct state_values wanted, kept;
	bool moved;
	int64_t next_ns; /* nothing condition written before */
};

/* The text of the file, which the caller frees. NULL: no memory. */
static char *print_values(const struct state_values *values, size_t *bytes)
{
	char *text = NULL;
	FILE *stream = open_memstream(&text, bytes);

	if (!stream)
		return NULL;
	fputs("; What was chosen last, written by inlay. Without this file the configuration counts.\n"
	      "[chosen]\n",
	      stream);
	for (const struct ini_key *key = keys; key->name; key++) {
		char value[INI_TEXT_MAX];

		ini_value_text(key, values, value, sizeof(value));
		fprintf(stream, "%s = %s\n", key->name, value);
	}
	return fclose(stream) ? NULL : text;
}

static bool same_values(const struct state_values *a, const struct state_values *b)
{
	return a->threshold.value == b->threshold.value &&
	       a->threshold.percent == b->threshold.percent && a->view == b->view &&
	       a->pose == b->pose;
}

static void write_if_due(struct state *state, bool last)
{
	const enum keeper_condition condition = keeper_look(state->keeper, KEEPER_STATE);
	const int64_t now_ns = clock_now_ns();
	int64_t interval_ns = (int64_t)(state->settings.interval_s * (double)NS_PER_S);
	size_t bytes;
	char *text;

	if (!*state->settings.file ||
	    !(state->moved || condition == KEEPER_FAILED ||
	      !same_values(&state->wanted, &state->kept)) ||
	    (!last && (condition == KEEPER_BUSY || now_ns < state->next_ns)))
		return;
	if (condition == KEEPER_FAILED && interval_ns < NS_PER_S)
		interval_ns = NS_PER_S;
	text = print_values(&state->wanted, &bytes);
	if (!text)
		return;
	keeper_put(state->keeper, KEEPER_STATE, state->settings.file, text, bytes);
	state->kept = state->wanted;
	state->moved = false;
	state->next_ns = now_ns + interval_ns;
}

int state_create(struct state **out, struct keeper *keeper, const struct config_state *settings,
		 const struct state_values *now)
{
	struct state *state = calloc(1, sizeof(*state));

	if (!state)
		return -ENOMEM;
	*state = (struct state){
		.keeper = keeper, .settings = *settings, .wanted = *now, .kept = *now};
	*out = state;
	return 0;
}

void state_move(struct state *state, const struct config_state *settings)
{
	if (!state)
		return;
	state->moved |= strcmp(state->settings.file, settings->file) != 0;
	state->settings = *settings;
	state->next_ns = 0;
	write_if_due(state, false);
}

void state_keep(struct state *state, const struct state_values *values)
{
	if (!state)
		return;
	state->wanted = *values;
	write_if_due(state, false);
}

void state_look(struct state *state)
{
	if (state)
		write_if_due(state, false);
}

void state_destroy(struct state *state)
{
	if (state)
		write_if_due(state, true);
	free(state);
}
