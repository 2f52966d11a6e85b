/* SPDX-License-Identifier: MIT */
#include "app/view/show.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "app/view/layout.h"
#include "app/view/marks.h"

/* What every way of drawing needs. */
struct drawing {
	struct show *show;
	const struct show_request *request;
	enum config_scale scale;
	struct pipeline *pipeline;
	const struct eyes *eyes;
	const struct display_buffer *screen;
	struct fault *fault;
};

void show_free(struct show *show)
{
	canvas_free(&show->after);
	canvas_free(&show->marked);
	for (int i = 0; i < 4; i++)
		scaler_free(&show->scalers[i]);
}

/* Of a camera that is open, whether it has delivered or not. */
static void fit_eye(struct show_fit *fit, const struct eye *eye)
{
	struct view view = eye->wanted;

	if (!eye->source || !source_is_open(eye->source) ||
	    view_resolve(&view, eye->source->camera.width, eye->source->camera.height, NULL))
		return;
	*fit = (struct show_fit){view.width, view.height, view.squash};
}

/* Of one picture: SHOW_QUAD is twice as wide and high. */
static struct show_fit fit_one(enum config_show what, const struct eyes *eyes,
			       const struct basis *basis)
{
	struct show_fit fit = {(int)basis->info.width, (int)basis->info.height,
			       eyes->background.wanted.squash};

	if (what == SHOW_FISHEYE)
		fit_eye(&fit, &eyes->fisheye);
	if (what == SHOW_SCENE)
		fit_eye(&fit, &eyes->scene);
	return fit;
}

static int copies_across(enum config_show what)
{
	return what == SHOW_QUAD ? 2 : 1;
}

struct show_fit show_fit(enum config_show what, const struct eyes *eyes, const struct basis *basis)
{
	struct show_fit fit = fit_one(what, eyes, basis);

	fit.width *= copies_across(what);
	fit.height *= copies_across(what);
	return fit;
}

void show_size(enum config_show what, const struct eyes *eyes, const struct basis *basis,
	       int *width, int *height)
{
	const struct show_fit fit = fit_one(what, eyes, basis);

	*width = fit.width * copies_across(what);
	*height = (int)lrint(fit.height * fit.squash) * copies_across(what);
}

static int canvas_fit(struct canvas *canvas, int width, int height)
{
	if (canvas->width == width && canvas->height == height)
		return 0;
	canvas_free(canvas);
	return canvas_create(canvas, width, height);
}

static double squash_of(const struct drawing *d, const struct eye *eye)
{
	return eye->view.squash / d->request->squash;
}

static int say_scaling(const struct drawing *d, int err)
{
	return err ? fault_say(d->fault, err, "not enough memory to scale a picture") : 0;
}

static struct picture canvas_picture(const struct canvas *canvas)
{
	const struct view whole = {.width = canvas->width, .height = canvas->height, .squash = 1};

	return view_picture(&whole, canvas->pixels, canvas->stride);
}

static int place(const struct drawing *d, const struct box *cell, const struct picture *picture,
		 double squash, int slot)
{
	return say_scaling(d, layout_place(d->screen, cell, picture, squash, d->scale,
					   &d->show->scalers[slot], d->pipeline->pool));
}

static int draw_eye(const struct drawing *d, const struct box *cell, const struct eye *eye,
		    int slot)
{
	struct picture picture;

	if (!eye_has_picture(eye)) {
		layout_black(d->screen, cell);
		return 0;
	}
	picture = eye_picture(eye);
	return place(d, cell, &picture, squash_of(d, eye), slot);
}

/* Read from the camera's own memory while the compositor goes over it, where that can be. */
static int composite(const struct drawing *d, uint8_t *out, size_t out_stride)
{
	const struct eye *eye = &d->eyes->background;
	struct frame_reader reader;
	struct backdrop backdrop;
	struct picture picture;

	if (eye_read(eye, &reader)) {
		backdrop = (struct backdrop){.width = eye->view.width,
					     .height = eye->view.height,
					     .make = frame_reader_make,
					     .context = &reader};
	} else {
		picture = eye_picture(eye);
		backdrop = backdrop_of(&picture);
	}
	return pipeline_composite(d->pipeline, &backdrop, out, out_stride, d->fault);
}

/* Into memory of its own. */
static int make_after(const struct drawing *d)
{
	const struct view *view = &d->eyes->background.view;
	struct canvas *after = &d->show->after;
	int err = canvas_fit(after, view->width, view->height);

	if (err)
		return fault_say(d->fault, err, "not enough memory for a picture of %dx%d",
				 view->width, view->height);
	return composite(d, after->pixels, after->stride);
}

/* Straight into the screen where it goes there pixel by pixel. */
static int draw_after(const struct drawing *d, const struct box *cell, int slot)
{
	const struct eye *eye = &d->eyes->background;
	const struct view *view = &eye->view;
	struct picture after;
	struct box box;
	int err;

	if (!eye_has_picture(eye)) {
		layout_black(d->screen, cell);
		return 0;
	}
	box = layout_box(cell, view->width, view->height, squash_of(d, eye), d->scale);
	if (layout_in_place(cell, &box, view->width, view->height)) {
		layout_border(d->screen, cell, &box);
		return composite(d,
				 d->screen->pixels + (size_t)box.y * d->screen->stride +
					 (size_t)box.x * 4,
				 d->screen->stride);
	}
	err = make_after(d);
	if (err)
		return err;
	after = canvas_picture(&d->show->after);
	return place(d, cell, &after, squash_of(d, eye), slot);
}

/* Composited aside although it may go there pixel by pixel: the screen's memory is written once. */
static int draw_split(const struct drawing *d, const struct box *cell)
{
	const struct eye *eye = &d->eyes->background;
	struct scaler *scaler = &d->show->scalers[0];
	struct picture background, after;
	struct box box;
	struct span line;
	int err;

	if (!eye_has_picture(eye)) {
		layout_black(d->screen, cell);
		return 0;
	}
	background = eye_picture(eye);
	err = make_after(d);
	if (err)
		return err;
	after = canvas_picture(&d->show->after);
	box = layout_box(cell, background.width, background.height, squash_of(d, eye), d->scale);
	line = layout_line(cell, &box, d->request->split);
	layout_border(d->screen, cell, &box);
	layout_draw_line(d->screen, cell, &box, &line);
	err = layout_fill(d->screen, cell, &box, &(struct span){cell->x, line.from}, &background,
			  scaler, d->pipeline->pool);
	if (!err)
		err = layout_fill(d->screen, cell, &box,
				  &(struct span){line.to, cell->x + cell->width}, &after, scaler,
				  d->pipeline->pool);
	return say_scaling(d, err);
}

static int draw_fisheye(const struct drawing *d, const struct box *cell, int slot)
{
	const struct eye *eye = &d->eyes->fisheye;
	struct canvas *marked = &d->show->marked;
	struct picture picture;
	struct box box;
	int err;

	if (!eye_has_picture(eye)) {
		layout_black(d->screen, cell);
		return 0;
	}
	picture = eye_picture(eye);
	err = canvas_fit(marked, picture.width, picture.height);
	if (err)
		return fault_say(d->fault, err, "not enough memory for a picture of %dx%d",
				 picture.width, picture.height);
	picture_copy(&picture, marked->pixels, marked->stride);
	box = layout_box(cell, picture.width, picture.height, squash_of(d, eye), d->scale);
	if (d->pipeline->lit)
		marks_draw(marked, &d->pipeline->dome, &d->pipeline->lens,
			   d->pipeline->selection.used, mark_side_px(picture.height, box.height));
	picture = canvas_picture(marked);
	return place(d, cell, &picture, squash_of(d, eye), slot);
}

static int draw_quad(struct drawing *d)
{
	struct box cell[4];
	int err;

	for (int i = 0; i < 4; i++)
		cell[i] = layout_quarter(d->screen, i);
	d->scale = SCALE_FIT;
	err = draw_eye(d, &cell[0], &d->eyes->scene, 0);
	if (!err)
		err = draw_fisheye(d, &cell[1], 1);
	if (!err)
		err = draw_eye(d, &cell[2], &d->eyes->background, 2);
	if (!err)
		err = draw_after(d, &cell[3], 3);
	return err;
}

static int draw_pictures(struct drawing *d)
{
	const struct box whole = layout_whole(d->screen);
	const enum config_show what = d->request->blank ? SHOW_OFF : d->request->what;

	switch (what) {
	case SHOW_BEFORE:
		return draw_eye(d, &whole, &d->eyes->background, 0);
	case SHOW_FISHEYE:
		return draw_fisheye(d, &whole, 0);
	case SHOW_SCENE:
		return draw_eye(d, &whole, &d->eyes->scene, 0);
	case SHOW_QUAD:
		return draw_quad(d);
	case SHOW_SPLIT:
		return draw_split(d, &whole);
	case SHOW_OFF:
		layout_black(d->screen, &whole);
		return 0;
	default:
		return draw_after(d, &whole, 0);
	}
}

int show_draw(struct show *show, const struct show_request *request, struct pipeline *pipeline,
	      const struct eyes *eyes, const struct display_buffer *screen, struct fault *fault)
{
	struct drawing d = {.show = show,
			    .request = request,
			    .scale = request->scale,
			    .pipeline = pipeline,
			    .eyes = eyes,
			    .screen = screen,
			    .fault = fault};
	int err = draw_pictures(&d);

	if (err || !request->overlay)
		return err;
	err = overlay_draw(request->overlay, screen);
	return err ? fault_say(fault, err, "not enough memory for text on the screen") : 0;
}
