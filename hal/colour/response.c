/* SPDX-License-Identifier: MIT */
#include "hal/colour/response.h"

#include <errno.h>
#include <string.h>

const struct ini_key response_keys[] = {
	{"black_level", INI_REAL, offsetof(struct response, black_level), .min = -1, .max = 254,
	 .fallback = "-1", .help = "Code value that is no light; -1: not measured."},
	{"response", INI_REALS, offsetof(struct response, knot), TRANSFER_KNOTS, .max = 1,
	 .fallback = "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0",
	 .help = "Linear light at evenly spaced code values from the black level to 255, ascending from 0 to 1; all 0: not measured."},
	{"gain", INI_REAL, offsetof(struct response, gain), .max = 1e6, .fallback = "0",
	 .help = "Linear light of this camera times gain is in the background camera's units; 0: not measured."},
	{"colours", INI_REALS, offsetof(struct response, colours), 9, .min = -100, .max = 100,
	 .fallback = "0 0 0 0 0 0 0 0 0",
	 .help = "This camera's linear R, G, B to the background's, row by row; all 0: not measured."},
	{"delay", INI_INT, offsetof(struct response, delay), .min = -1, .max = 30, .fallback = "-1",
	 .unit = "frames",
	 .help = "How many frames still show the exposure before when it is changed; -1: not measured."},
	INI_KEYS_END};

struct response_reading {
	struct response *response;
	bool found; /* the file has a section [light] */
};

static void *response_place(void *root, const char *instance)
{
	struct response_reading *r = root;

	(void)instance;
	r->found = true;
	return r->response;
}

static bool all_zero(const double *x, int count)
{
	for (int i = 0; i < count; i++)
		if (x[i] != 0)
			return false;
	return true;
}

void response_begin(struct response *response)
{
	memset(response, 0, sizeof(*response)); /* with padding: callers compare the bytes */
	ini_defaults(response_keys, response);
}

struct transfer_curve response_curve(const struct response *r, enum transfer named,
				     double black_level)
{
	struct transfer_curve curve;

	memset(&curve, 0, sizeof(curve));
	curve.named = named;
	curve.black = r->black_level >= 0 ? r->black_level : black_level;
	curve.measured = !all_zero(r->knot, TRANSFER_KNOTS);
	memcpy(curve.knot, r->knot, sizeof(curve.knot));
	return curve;
}

double response_gain(const struct response *r, double gain)
{
	return r->gain > 0 ? r->gain : gain;
}

/* Number of the last line that sets the key; 1 if there is none. */
static int key_line(const char *path, const char *key)
{
	FILE *file = fopen(path, "r");
	char text[4096];
	int line = 0, found = 1;

	while (file && fgets(text, sizeof(text), file)) {
		const char *at = text + strspn(text, " \t");

		line++;
		if (!strncmp(at, key, strlen(key)) && strchr(" \t=:", at[strlen(key)]))
			found = line;
	}
	if (file)
		fclose(file);
	return found;
}

/* Checks the knots together; ini_read() has checked each number alone. */
static int response_check(const struct response *r, const char *path, struct ini_report *report)
{
	const struct transfer_curve curve = response_curve(r, TRANSFER_SRGB, 0);
	struct fault what = {.text = ""}, fault = {.text = ""};

	if (transfer_curve_check(&curve, &what) == 0)
		return 0;
	fault_say(&fault, -EINVAL, "%.500s:%d: [light] response: %.400s", path,
		  key_line(path, "response"), what.text);
	ini_report_add(report, &fault);
	return -EINVAL;
}

int response_read(struct response *response, const char *path, struct ini_report *report)
{
	const struct ini_table tables[] = {
		{"light", .keys = response_keys, .place = response_place}, INI_TABLES_END};
	struct response_reading reading = {.response = response};
	struct fault fault = {.text = ""};
	int err;

	response_begin(response);
	err = ini_read(path, tables, &reading, report);
	if (!err && !reading.found) {
		fault_say(
			&fault, -EINVAL,
			"%.500s:1: has no section [light], expected a file that inlay-calibrate light wrote",
			path);
		ini_report_add(report, &fault);
		err = -EINVAL;
	}
	if (!err)
		err = response_check(response, path, report);
	if (err)
		response_begin(response);
	return err;
}
