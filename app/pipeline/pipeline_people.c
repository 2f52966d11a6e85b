/* SPDX-License-Identifier: MIT */
/* People between camera and object (hal/people/people.h). */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/image/image.h"
#include "hal/people/people.h"

#define MASK_DARK 128 /* code value below which nobody is looked for */

struct pipeline_people {
	struct people *people;
	struct tsai_camera camera; /* width 0: not known */
	uint8_t *touched;	   /* [tiles]: see struct people_object */
	int pose;		   /* of touched; -1: none yet */
	unsigned turn;		   /* of its blocks, when touched was made */
	uint8_t *shown;		   /* [height][width]: see struct people_object; NULL: no mask */
	bool looked;
};

int pipeline_read_mask(const char *path, const struct basis *basis, uint8_t **out,
		       struct fault *fault)
{
	const int width = (int)basis->info.width, height = (int)basis->info.height;
	struct fault reason = {.text = ""};
	struct image image;
	uint8_t *shown = NULL;
	int err;

	*out = NULL;
	if (!*path)
		return 0;
	err = image_read_sized(path, width, height, "as the basis was baked", &image, &reason);
	if (err)
		return fault_say(fault, err, "[people] mask: %s", reason.text);
	if (!image.u8)
		err = fault_say(fault, -ENOTSUP,
				"[people] mask: %s holds light, expected PNG, JPEG or WebP", path);
	else if (!(shown = malloc((size_t)width * (size_t)height)))
		err = fault_say(fault, -ENOMEM, "not enough memory for [people] mask");
	for (int i = 0; !err && i < width * height; i++) {
		const uint8_t *rgb = image.u8 + 3 * (size_t)i;

		/* Luminance in eighths, as any grey is itself. */
		shown[i] = 2 * rgb[0] + 5 * rgb[1] + rgb[2] >= 8 * MASK_DARK;
	}
	image_free(&image);
	*out = shown;
	return err;
}

/* The mask of settings, read unless its pixels are given. */
static int take_mask(const struct pipeline_settings *settings, const struct basis *basis,
		     uint8_t **out, struct fault *fault)
{
	const size_t pixels = (size_t)basis->info.width * basis->info.height;

	if (!settings->mask_pixels)
		return pipeline_read_mask(settings->mask, basis, out, fault);
	*out = malloc(pixels);
	if (!*out)
		return fault_say(fault, -ENOMEM, "not enough memory for [people] mask");
	memcpy(*out, settings->mask_pixels, pixels);
	return 0;
}

void pipeline_people_free(struct pipeline *p)
{
	if (!p->people)
		return;
	people_destroy(p->people->people);
	free(p->people->touched);
	free(p->people->shown);
	free(p->people);
	p->people = NULL;
}

int pipeline_people_prepare(struct pipeline *p, const struct pipeline_settings *settings,
			    struct fault *fault)
{
	const struct people_settings wanted = {
		.width = (int)p->basis->info.width,
		.height = (int)p->basis->info.height,
		.curve = settings->background,
		.dome = &p->dome,
		.camera = settings->camera,
		.calibration = p->basis->camera,
		.depth_camera = settings->depth_camera.width ? &settings->depth_camera : NULL,
	};
	const bool same = transfer_curve_same(&settings->background, &p->settings.background);
	struct pipeline_people *pp;
	uint8_t *shown;
	int err;

	if (!settings->occlude) {
		pipeline_people_free(p);
		return 0;
	}
	if (p->people && same && !strcmp(settings->mask, p->settings.mask))
		return 0;
	err = take_mask(settings, p->basis, &shown, fault);
	if (err)
		return err;
	if (p->people && same) {
		free(p->people->shown);
		p->people->shown = shown;
		p->people->pose = -1; /* people_place() tells it */
		return 0;
	}
	pp = calloc(1, sizeof(*pp));
	if (pp)
		pp->touched = calloc((size_t)(p->basis->tiles_across * p->basis->tiles_down), 1);
	err = pp && pp->touched
		      ? people_create(&pp->people, &wanted, fault)
		      : fault_say(fault, -ENOMEM, "not enough memory for the place without people");
	if (err) {
		if (pp)
			free(pp->touched);
		free(pp);
		free(shown);
		return err;
	}
	pp->shown = shown;
	if (tsai_read_text(p->basis->camera, &pp->camera, NULL))
		pp->camera.width = 0;
	pp->pose = -1;
	pipeline_people_free(p);
	p->people = pp;
	return 0;
}

/* Marks the tiles that a pose changes. */
static void touch_tiles(const struct basis *basis, const struct basis_pose *pose, uint8_t *touched)
{
	const size_t width = basis->info.width, height = basis->info.height;

	for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++)
		touched[t] = pose->shown.tiles[t].block_count > 0;
	for (size_t y = 0; y < height; y++)
		for (size_t x = 0; x < width; x++)
			if (pose->coverage[y * width + x])
				touched[y / BASIS_TILE * (size_t)basis->tiles_across +
					x / BASIS_TILE] = 1;
	for (size_t i = 0; i < pose->glass_count; i++)
		touched[basis_glass_tile(basis, &pose->glass[i])] = 1;
}

/* Tells where the object of the picture's pose stands. False: it is the one before. */
static bool take_pose(struct pipeline *p)
{
	const struct basis_pose *pose = &p->basis->poses[p->choice.pose];
	struct pipeline_people *pp = p->people;
	struct people_object object = {
		.coverage = pose->coverage, .touched = pp->touched, .shown = pp->shown};

	if (pp->pose == p->choice.pose && pp->turn == pose->turn)
		return false;
	touch_tiles(p->basis, pose, pp->touched);
	if (pp->camera.width)
		object.camera = &pp->camera;
	if (p->basis->feet)
		object.foot = &p->basis->feet[p->choice.pose];
	people_place(pp->people, &object);
	pp->pose = p->choice.pose;
	pp->turn = pose->turn;
	return true;
}

void pipeline_people_look(struct pipeline *p, const struct picture *background,
			  const struct depth_map *depth, int64_t captured_ns, bool fresh)
{
	struct pipeline_people *pp = p->people;

	if (!p->basis->poses[p->choice.pose].shown.tiles)
		return;
	if (take_pose(p) || fresh) {
		people_take_depth(pp->people, depth);
		people_look(pp->people, background, (const float(*)[3])p->light.radiance,
			    captured_ns);
	}
	pp->looked = true;
}

const struct veil *pipeline_veil(const struct pipeline *p)
{
	return p->settings.occlude && p->people && p->people->looked
		       ? people_veil(p->people->people)
		       : NULL;
}

void pipeline_learn(struct pipeline *p)
{
	if (p->people)
		people_learn(p->people->people);
}

void pipeline_forget(struct pipeline *p)
{
	if (p->people)
		people_forget(p->people->people);
}

const struct sensor_noise *pipeline_people_noise(const struct pipeline *p)
{
	return p->people ? people_noise(p->people->people) : NULL;
}

size_t pipeline_learned_bytes(const struct pipeline *p)
{
	return p->people ? people_saved_bytes(p->people->people) : 0;
}

size_t pipeline_learned_save(const struct pipeline *p, void *to, size_t done)
{
	return people_save(p->people->people, to, done);
}

int pipeline_learned_restore(struct pipeline *p, const void *from, size_t bytes,
			     struct fault *fault)
{
	return people_restore(p->people->people, from, bytes, fault);
}

struct pipeline_people_seen pipeline_people_seen(const struct pipeline *p)
{
	struct people_report report;

	if (!p->people)
		return (struct pipeline_people_seen){.on = false};
	report = people_report(p->people->people);
	return (struct pipeline_people_seen){true,
					     p->people->looked,
					     report.learned,
					     report.parts,
					     report.in_front,
					     report.sure,
					     {report.moved_px[0], report.moved_px[1]},
					     report.lost};
}
