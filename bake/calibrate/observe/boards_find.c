/* SPDX-License-Identifier: MIT */
/* Adds the board that is found in a picture to the observations, as a view. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/observe/boards.h"
#include "bake/calibrate/observe/boards_parts.h"

static int add_points(const struct board *board, const char *name, const double (*px)[2],
		      const bool *seen, struct observations *all)
{
	const char *slash = strrchr(name, '/');
	const int columns = board_columns(board);
	int err = observations_begin_view(all, name);

	for (int k = 0; !err && k < board_points(board); k++) {
		double world[3];

		if (!seen[k])
			continue;
		board_point(board, k, world);
		err = observations_add(all, world, px[k], "%s %d,%d", slash ? slash + 1 : name,
				       k % columns + 1, k / columns + 1);
	}
	return err;
}

static int check_size(const struct image *picture, const char *name, const struct observations *all,
		      struct fault *fault)
{
	if (!all->width || (all->width == picture->width && all->height == picture->height))
		return 0;
	return fault_say(fault, -ERANGE, "%s: is %dx%d, expected %dx%d as the others: skipped",
			 name, picture->width, picture->height, all->width, all->height);
}

int board_find(const struct board *board, const struct image *picture, const char *name,
	       struct observations *all, struct fault *fault)
{
	const int points = board_points(board), count = all->count, views = all->views;
	const int pictures = all->pictures;
	struct fault why = {{0}};
	double(*px)[2];
	bool *seen;
	int err = check_size(picture, name, all, fault);

	if (err)
		return err;
	px = calloc((size_t)points, sizeof(*px));
	seen = calloc((size_t)points, sizeof(*seen));
	err = px && seen ? board_look(board, picture, px, seen, &why) : -ENOMEM;
	if (!err)
		err = add_points(board, name, (const double(*)[2])px, seen, all);
	if (!err) {
		all->width = picture->width;
		all->height = picture->height;
	} else {
		all->count = count;
		all->views = views;
		all->pictures = pictures;
		fault_say(fault, err, "%s: %s", name, err == -ENOMEM ? "out of memory" : why.text);
	}
	free(px);
	free(seen);
	return err;
}
