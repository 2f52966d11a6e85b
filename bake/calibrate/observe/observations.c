/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/observe/observations.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/number.h"
#include "hal/base/text_file.h"

#define NUMBERS 5 /* of a line: xw yw zw xf yf */

void observations_free(struct observations *all)
{
	free(all->point);
	free(all->view);
	*all = (struct observations){0};
}

/* Makes room for one more element, in steps of a factor of two. */
static int observations_make_room(void **array, int count, int *room, size_t size)
{
	const int more = *room ? 2 * *room : 64;
	void *grown;

	if (count < *room)
		return 0;
	grown = realloc(*array, (size_t)more * size);
	if (!grown)
		return -ENOMEM;
	*array = grown;
	*room = more;
	return 0;
}

int observations_begin_view(struct observations *all, const char *name)
{
	int err = observations_make_room((void **)&all->view, all->views, &all->view_room,
					 sizeof(*all->view));

	if (err)
		return err;
	all->view[all->views] = (struct observed_view){.first = all->count,
						       .number = all->pictures + 1};
	snprintf(all->view[all->views].name, sizeof(all->view->name), "%s", name);
	all->views++;
	all->pictures++;
	return 0;
}

int observations_add(struct observations *all, const double world[3], const double px[2],
		     const char *format, ...)
{
	struct observation *point;
	va_list args;
	int err = observations_make_room((void **)&all->point, all->count, &all->point_room,
					 sizeof(*all->point));

	if (err)
		return err;
	point = &all->point[all->count++];
	*point = (struct observation){.view = all->views - 1};
	memcpy(point->world, world, sizeof(point->world));
	memcpy(point->px, px, sizeof(point->px));
	va_start(args, format);
	vsnprintf(point->name, sizeof(point->name), format, args);
	va_end(args);
	all->view[point->view].count++;
	return 0;
}

static bool same_view(const struct observations *all, const struct observed_view *a,
		      const struct observed_view *b)
{
	for (int k = 0; k < a->count && a->count == b->count; k++) {
		const struct observation *p = &all->point[a->first + k];
		const struct observation *q = &all->point[b->first + k];

		if (memcmp(p->world, q->world, sizeof(p->world)) ||
		    memcmp(p->px, q->px, sizeof(p->px)))
			return false;
	}
	return a->count && a->count == b->count;
}

bool observations_twin(const struct observations *all, int twin[2])
{
	for (twin[0] = 1; twin[0] < all->views; twin[0]++)
		for (twin[1] = 0; twin[1] < twin[0]; twin[1]++)
			if (same_view(all, &all->view[twin[0]], &all->view[twin[1]]))
				return true;
	return false;
}

/* ---- files of points ---- */

int observations_numbers(char *line, double *number, int most)
{
	const char *at = line;
	int count = 0;

	line[strcspn(line, "#\r")] = 0;
	for (;;) {
		double value;

		at += strspn(at, " \t,;");
		if (!*at)
			return count;
		if (number_read(&at, &value) || (*at && !strchr(" \t,;", *at)))
			return -EINVAL;
		if (count == most)
			return count + 1;
		number[count++] = value;
	}
}

#define LINE "xw yw zw xf yf"

static int read_point(struct observations *all, const struct text_file *file,
		      const struct points_convention *convention, struct fault *fault)
{
	const char *slash = strrchr(file->path, '/');
	double number[NUMBERS], px[2];
	const int count = observations_numbers(file->line, number, NUMBERS);

	if (!count)
		return 0;
	if (count != NUMBERS)
		return fault_say(fault, -EINVAL, "%s:%d: expected five finite numbers: " LINE,
				 file->path, file->number);
	px[0] = number[3] + 0.5 - convention->pixel_centre;
	px[1] = number[4] + 0.5 - convention->pixel_centre;
	if (convention->y_up)
		px[1] = convention->height - px[1];
	return observations_add(all, number, px, "%s:%d", slash ? slash + 1 : file->path,
				file->number);
}

int observations_read(struct observations *all, const char *path,
		      const struct points_convention *convention, struct fault *fault)
{
	const int before = all->count, views = all->views, pictures = all->pictures;
	struct text_file file;
	int err = text_file_open(&file, path, fault);

	if (err)
		return err;
	err = observations_begin_view(all, path);
	while (!err && (err = text_file_next(&file, fault)) > 0)
		err = read_point(all, &file, convention, fault);
	if (!err && all->count == before)
		err = fault_say(fault, -EINVAL, "%s: holds no points, expected lines " LINE, path);
	if (err == -ENOMEM)
		fault_say(fault, err, "%s: out of memory", path);
	if (err) {
		all->count = before;
		all->views = views;
		all->pictures = pictures;
	}
	text_file_close(&file);
	return err;
}
