/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/observe/gather.h"

#include <errno.h>
#include <glob.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/observe/live_collect.h"
#include "hal/base/log.h"

#define PATIENCE_S 60

void gather_free(struct gathering *all)
{
	for (int k = 0; k < all->pictures; k++)
		image_free(&all->picture[k]);
	free(all->picture);
	free(all->boardless);
	observations_free(&all->seen);
	*all = (struct gathering){.picture = NULL};
}

/* A picture listed twice would make everything look better known than it is. */
static int refuse_twins(const struct gathering *all, struct fault *fault)
{
	int twin[2];

	if (!observations_twin(&all->seen, twin))
		return 0;
	return fault_say(fault, -EINVAL, "%s: shows just what %s does, expected different pictures",
			 all->seen.view[twin[0]].name, all->seen.view[twin[1]].name);
}

int gather_points(struct gathering *all, char *const *paths, int count,
		  const struct points_convention *convention, struct fault *fault)
{
	int err = 0;

	for (int k = 0; k < count && !err; k++)
		err = observations_read(&all->seen, paths[k], convention, fault);
	return err ? err : refuse_twins(all, fault);
}

int gather_keep(struct gathering *all, struct image *picture)
{
	struct image *grown = realloc(all->picture, ((size_t)all->pictures + 1) * sizeof(*grown));

	if (!grown)
		return -ENOMEM;
	all->picture = grown;
	all->picture[all->pictures++] = *picture;
	*picture = (struct image){.width = 0};
	return 0;
}

static int gather_image(struct gathering *all, const char *path, struct board *board,
			struct fault *fault)
{
	struct image picture;
	int err = image_read(path, &picture, fault);

	if (!err && !picture.u8)
		err = fault_say(fault, -EINVAL, "%s: expected an 8-bit picture, PNG or JPEG", path);
	if (!err)
		err = board_find(board, &picture, path, &all->seen, fault);
	if (err == -ERANGE) {
		all->misfits++;
		all->misfit_width = picture.width;
		all->misfit_height = picture.height;
	}
	if (!err && gather_keep(all, &picture))
		err = fault_say(fault, -ENOMEM, "%s: out of memory", path);
	image_free(&picture);
	return err;
}

static int gather_boardless(struct gathering *all, const char *path)
{
	struct observed_view *grown = realloc(all->boardless,
					      ((size_t)all->boardlesses + 1) * sizeof(*grown));

	if (!grown)
		return -ENOMEM;
	all->boardless = grown;
	grown += all->boardlesses++;
	*grown = (struct observed_view){.number = ++all->seen.pictures};
	snprintf(grown->name, sizeof(grown->name), "%s", path);
	return 0;
}

static bool is_skipped(int err)
{
	return err == -ENOENT || err == -ERANGE || err == -EBADMSG || err == -ENOTSUP;
}

/* Finds the board in the photographs of a pattern. *none holds the fault of the last photograph
 * that was skipped; the one before goes to the log. */
static int gather_pattern(struct gathering *all, const char *pattern, struct board *board,
			  struct fault *none, struct fault *fault)
{
	glob_t found;
	int err = glob(pattern, 0, NULL, &found);

	if (err)
		return fault_say(fault, err == GLOB_NOSPACE ? -ENOMEM : -ENOENT, "%s: %s", pattern,
				 err == GLOB_NOSPACE ? "out of memory" : "no such photograph");
	for (size_t k = 0; k < found.gl_pathc && !err; k++) {
		struct fault why = {.text = ""};

		err = gather_image(all, found.gl_pathv[k], board, &why);
		if (is_skipped(err)) {
			if (none->text[0])
				log_warning("%s", none->text);
			*none = why;
			err = gather_boardless(all, found.gl_pathv[k]);
			if (err)
				fault_say(&why, err, "%s: out of memory", found.gl_pathv[k]);
		}
		if (err && fault)
			*fault = why;
	}
	globfree(&found);
	return err;
}

static int gather_patterns(struct gathering *all, char *const *patterns, int count,
			   struct board *board, struct fault *none, struct fault *fault)
{
	int err = 0;

	for (int k = 0; k < count && !err; k++)
		err = gather_pattern(all, patterns[k], board, none, fault);
	return err;
}

int gather_images(struct gathering *all, char *const *patterns, int count, struct board *board,
		  struct fault *fault)
{
	struct fault none = {.text = ""};
	int err = gather_patterns(all, patterns, count, board, &none, fault);

	/* the first with a board may be the one that does not fit the others */
	if (!err && all->misfits > all->seen.views) {
		const int width = all->misfit_width, height = all->misfit_height;

		log_info("most photographs are %dx%d: these count", width, height);
		none = (struct fault){.text = ""};
		gather_free(all);
		all->seen.width = width;
		all->seen.height = height;
		err = gather_patterns(all, patterns, count, board, &none, fault);
	}
	if (!err && !all->seen.count)
		return fault_say(fault, -ENOENT, "%s", none.text);
	if (none.text[0])
		log_warning("%s", none.text);
	return err ? err : refuse_twins(all, fault);
}

int gather_live(struct gathering *all, const char *config, enum live_view view, struct board *board,
		int views, int world, struct fault *fault)
{
	const struct collect_settings settings = {.views = views,
						  .patience_s = PATIENCE_S,
						  .round = view == LIVE_FISHEYE,
						  .world = world};
	struct live *live;
	int err = live_open(&live, config, view, fault);

	if (err)
		return err;
	err = live_collect(live, board, &settings, &all->seen, &all->picture, &all->pictures,
			   fault);
	live_close(live);
	return err;
}

static bool view_is(const struct observed_view *view, const char *text)
{
	const char *slash = strrchr(view->name, '/');
	char *end;
	const long number = strtol(text, &end, 10);

	if (end != text && !*end)
		return view->number == number;
	return !strcmp(view->name, text) || (slash && !strcmp(slash + 1, text));
}

int gather_view(const struct gathering *all, const char *text, const char **boardless)
{
	for (int v = 0; v < all->seen.views; v++)
		if (view_is(&all->seen.view[v], text))
			return v;
	for (int k = 0; k < all->boardlesses; k++)
		if (view_is(&all->boardless[k], text)) {
			*boardless = all->boardless[k].name;
			return -ENOENT;
		}
	return -EINVAL;
}
