/* SPDX-License-Identifier: MIT */
#include "bake/base/angles.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/number.h"
#include "hal/base/text_file.h"
#include "hal/basis/basis_format.h"

struct angle_line {
	double direction[3];
	int number; /* in the file */
};

struct angle_lines {
	struct angle_line *line;
	int count;
	int fine; /* above 0: frequency of a base dome that is finer in parts */
};

/* Tells whether a line says that the dome is finer in parts. */
static bool is_fine(const char *text, int *frequency)
{
	int of, length = 0;

	if (sscanf(text, "fine %2d %n", &of, &length) != 1 || text[length] || of < 1 ||
	    of > DOME_FREQUENCY_MAX)
		return false;
	*frequency = of;
	return true;
}

/* Reads two numbers. False when the line holds anything else. */
static bool read_angles(const char *text, double *theta, double *phi)
{
	text += strspn(text, " \t");
	if (number_read(&text, theta) || !strchr(" \t", *text) || !*text)
		return false;
	text += strspn(text, " \t");
	return !number_read(&text, phi) && !text[strspn(text, " \t\r")];
}

static int angles_read_line(struct angle_lines *all, const struct text_file *file,
			    struct fault *fault)
{
	const char *text = file->line;
	struct angle_line *grown;
	double theta, phi;

	if (text[strspn(text, " \t\r")] == '\0' || *text == '#')
		return 0;
	if (!all->count && is_fine(text, &all->fine))
		return 0;
	if (!read_angles(text, &theta, &phi) || theta < 0 || theta > M_PI / 2 + 1e-6)
		return fault_say(
			fault, -EINVAL,
			"%s:%d: expected theta and phi in radians, theta from 0 (zenith) to 1.571 (horizon)",
			file->path, file->number);
	if (all->count == BASIS_LIGHTS_MAX)
		return fault_say(fault, -EINVAL, "%s:%d: one light too many, expected at most %d",
				 file->path, file->number, BASIS_LIGHTS_MAX);
	grown = realloc(all->line, (size_t)(all->count + 1) * sizeof(*grown));
	if (!grown)
		return fault_say(fault, -ENOMEM, "%s: out of memory", file->path);
	all->line = grown;
	grown[all->count++] = (struct angle_line){
		.direction = {sin(theta) * cos(phi), sin(theta) * sin(phi), fmax(cos(theta), 0)},
		.number = file->number,
	};
	return 0;
}

static int angles_read_lines(struct angle_lines *all, const char *path, struct fault *fault)
{
	struct text_file file;
	int err = text_file_open(&file, path, fault);

	while (!err && (err = text_file_next(&file, fault)) > 0)
		err = angles_read_line(all, &file, fault);
	text_file_close(&file);
	return err;
}

/* Creates the dome that has as many lights; -ENOENT: there is none. */
static int create_of_count(struct dome *dome, int count, struct fault *fault)
{
	for (int f = 1; f <= DOME_FREQUENCY_MAX && 5 * f * f <= count; f++) {
		const int err = dome_create(dome, f, fault);

		if (err || dome->count == count)
			return err;
		dome_free(dome);
	}
	return -ENOENT;
}

/* Finds the dome's light of each line. Returns 0, the number of a line that fits no light, or
 * -ENOMEM. */
static int match_lines(const struct angle_lines *all, const struct dome *dome, int *light)
{
	const double spacing = sqrt(2 * M_PI / dome->count);
	const double least = cos(ANGLES_TOLERANCE * spacing);
	char *taken = calloc((size_t)dome->count, 1);
	int stray = 0;

	if (!taken)
		return -ENOMEM;
	for (int k = 0; k < all->count && !stray; k++) {
		const double *d = all->line[k].direction;
		const int i = dome_cell_of(dome, d);
		const double *there = dome->direction[i < 0 ? 0 : i];

		if (i < 0 || taken[i] ||
		    d[0] * there[0] + d[1] * there[1] + d[2] * there[2] < least)
			stray = all->line[k].number;
		else
			taken[i] = 1;
		light[k] = i;
	}
	free(taken);
	return stray;
}

/* The lines of a dome that is finer in parts are its nodes. */
static int take_nodes(const struct angle_lines *all, const char *path, struct dome *dome,
		      int *light, struct fault *fault)
{
	const int stride = sizeof(*all->line) / sizeof(double);
	struct fault what = {.text = ""};
	int err;

	_Static_assert(sizeof(struct angle_line) % sizeof(double) == 0, "lines are whole doubles");
	if (!all->count)
		return fault_say(fault, -EINVAL, "%s: no lights", path);
	err = dome_create_nodes(dome, all->line[0].direction, stride, all->count, all->fine, &what);
	for (int k = 0; k < all->count; k++)
		light[k] = k;
	return err ? fault_say(fault, err, "%s: %s", path, what.text) : 0;
}

static int find_dome(const struct angle_lines *all, const char *path, struct dome *dome, int *light,
		     struct fault *fault)
{
	int err;

	if (all->fine)
		return take_nodes(all, path, dome, light, fault);
	err = create_of_count(dome, all->count, fault);
	if (err == -ENOENT)
		return fault_say(
			fault, -EINVAL,
			"%s: %d lights, expected as many as a dome has: 6, 26, 46, 86, 186, 406 ... (inlay-bake dome)",
			path, all->count);
	if (err)
		return err;
	err = match_lines(all, dome, light);
	if (!err)
		return 0;
	dome_free(dome);
	if (err < 0)
		return fault_say(fault, err, "%s: out of memory", path);
	return fault_say(
		fault, -EINVAL,
		"%s:%d: is no light of a dome of %d lights, or is there twice, expected those that inlay-bake dome --angles prints, in any order",
		path, err, all->count);
}

int angles_read(const char *path, struct dome *dome, int **light, struct fault *fault)
{
	struct angle_lines all = {.count = 0};
	int err = angles_read_lines(&all, path, fault);

	*dome = (struct dome){.count = 0};
	*light = NULL;
	if (!err) {
		*light = calloc((size_t)all.count + 1, sizeof(**light));
		err = *light ? find_dome(&all, path, dome, *light, fault)
			     : fault_say(fault, -ENOMEM, "%s: out of memory", path);
	}
	if (err) {
		free(*light);
		*light = NULL;
	}
	free(all.line);
	return err;
}

void angles_write(FILE *stream, const struct dome *dome)
{
	if (dome_is_fine(dome))
		fprintf(stream, "fine %d\n", dome->frequency);
	for (int i = 0; i < dome->count; i++) {
		double theta, phi;

		dome_angles(dome, i, &theta, &phi);
		fprintf(stream, "%.17g %.17g\n", theta, phi);
	}
}
