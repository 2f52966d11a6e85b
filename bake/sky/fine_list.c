/* SPDX-License-Identifier: MIT */
#include "bake/sky/fine_list.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/number.h"
#include "hal/base/text_file.h"
#include "hal/optics/vec.h"

#define DEGREE (M_PI / 180)
/* Two parts whose middles are nearer than this are the same direction, rad. */
#define SAME_RAD 1e-6

void fine_list_free(struct fine_list *list)
{
	free(list->part);
	free(list->place);
	*list = (struct fine_list){.count = 0};
}

static int fine_list_wrong(const struct fine_list *list, int place, const char *what,
			   struct fault *fault)
{
	return fault_say(fault, -EINVAL, "%s%d: %s", list->name, place, what);
}

/* Reads four numbers. False when the text holds anything else. */
static bool read_numbers(const char *text, double number[4])
{
	for (int k = 0; k < 4; k++) {
		text += strspn(text, " \t");
		if (number_read(&text, &number[k]) || !strchr(" \t\r", *text))
			return false;
	}
	return !text[strspn(text, " \t\r")];
}

static int fine_list_add(struct fine_list *list, const char *text, int place, struct fault *fault)
{
	const size_t room = (size_t)list->count + 1;
	struct dome_fine *part = realloc(list->part, room * sizeof(*part));
	int *places = realloc(list->place, room * sizeof(*places));
	double number[4];

	if (part)
		list->part = part;
	if (places)
		list->place = places;
	if (!part || !places)
		return fault_say(fault, -ENOMEM, "%s%d: out of memory", list->name, place);
	if (!read_numbers(text, number) || number[3] != floor(number[3]) || number[3] < 1 ||
	    number[3] > DOME_FREQUENCY_MAX)
		return fine_list_wrong(
			list, place,
			"expected \"azimuth height radius frequency\", in degrees, such as \"120 35 2 36\"",
			fault);
	if (number[1] < 0 || number[1] > 90)
		return fine_list_wrong(
			list, place,
			"the direction is below the horizon or beyond the zenith, expected a height of 0 to 90 degrees",
			fault);
	if (number[2] < 0 || number[2] > 90)
		return fine_list_wrong(list, place, "expected a radius of 0 to 90 degrees", fault);
	part += list->count;
	*part = (struct dome_fine){
		.direction = {cos(number[1] * DEGREE) * cos(number[0] * DEGREE),
			      cos(number[1] * DEGREE) * sin(number[0] * DEGREE),
			      sin(number[1] * DEGREE)},
		.radius_rad = number[2] * DEGREE,
		.frequency = (int)number[3],
	};
	for (int k = 0; k < list->count; k++)
		if (vec_angle(list->part[k].direction, part->direction) < SAME_RAD)
			return fine_list_wrong(list, place, "this direction is there twice", fault);
	list->place[list->count++] = place;
	return 0;
}

static int read_parts(struct fine_list *list, const char *what, const char *text,
		      struct fault *fault)
{
	int err = 0, place = 0;

	snprintf(list->name, sizeof(list->name), "%s: part ", what);
	while (!err && *text) {
		char one[256];
		const size_t length = strcspn(text, ",");

		snprintf(one, sizeof(one), "%.*s", (int)length, text);
		err = fine_list_add(list, one, ++place, fault);
		text += length + (text[length] == ',');
	}
	return err;
}

static int read_file(struct fine_list *list, const char *path, struct fault *fault)
{
	struct text_file file;
	int err = text_file_open(&file, path, fault);

	snprintf(list->name, sizeof(list->name), "%s:", path);
	while (!err && (err = text_file_next(&file, fault)) > 0) {
		file.line[strcspn(file.line, "#")] = '\0';
		err = 0;
		if (file.line[strspn(file.line, " \t\r")])
			err = fine_list_add(list, file.line, file.number, fault);
	}
	text_file_close(&file);
	return err;
}

int fine_list_read(struct fine_list *list, const char *what, const char *text, const char *folder,
		   struct fault *fault)
{
	char path[1024];
	int err;

	*list = (struct fine_list){.count = 0};
	if (isdigit((unsigned char)*text) || strchr("+-.", *text)) {
		err = read_parts(list, what, text, fault);
	} else {
		const bool plain = *text == '/' || !folder || !*folder;
		const int length = snprintf(path, sizeof(path), "%s%s%s", plain ? "" : folder,
					    plain ? "" : "/", text);

		err = (size_t)length < sizeof(path)
			      ? read_file(list, path, fault)
			      : fault_say(fault, -ENAMETOOLONG, "%s: the path is too long", what);
	}
	if (err)
		fine_list_free(list);
	return err;
}

int fine_list_dome(const struct fine_list *list, int frequency, struct dome *dome,
		   struct fault *fault)
{
	struct fault what = {.text = ""};
	int wrong;
	const int err = dome_create_fine(dome, frequency, list ? list->part : NULL,
					 list ? list->count : 0, &wrong, &what);

	if (err && wrong >= 0)
		return fault_say(fault, err, "%s%d: %s", list->name, list->place[wrong], what.text);
	return err ? fault_say(fault, err, "%s", what.text) : 0;
}

void fine_list_write(FILE *stream, const struct dome_fine *part)
{
	const double *d = part->direction;

	fprintf(stream, "%.4f %.4f %.4f %d\n", atan2(d[1], d[0]) / DEGREE,
		atan2(d[2], hypot(d[0], d[1])) / DEGREE, part->radius_rad / DEGREE,
		part->frequency);
}
