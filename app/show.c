#include "app/show.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "app/layout.h"
#include "app/marks.h"

/* What every way of drawing needs. */
struct drawing {
	struct show *show;
	struct pipeline *pipeline;
	const struct eyes *eyes;
	const struct display_buffer *screen;
	enum config_scale scale;
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
static void eye_size(const struct eye *eye, int *width, int *height)
{
	struct view view = eye->wanted;

	if (!eye->source || !source_is_open(eye->source) ||
	    view_resolve(&view, eye->source->camera.width, eye->source->camera.height, NULL))
		return;
	*width = view.width;
	*height = (int)lrint(view.height * view.squash);
}

void show_size(enum config_show what, const struct eyes *eyes, const struct basis *basis,
	       int *width, int *height)
{
	int copies = what == SHOW_QUAD ? 2 : 1;

	*width = (int)basis->info.width;
	*height = (int)lrint(basis->info.height * eyes->background.wanted.squash);
	if (what == SHOW_FISHEYE)
		eye_size(&eyes->fisheye, width, height);
	if (what == SHOW_SCENE)
		eye_size(&eyes->scene, width, height);
	*width *= copies;
	*height *= copies;
}

static int canvas_fit(struct canvas *canvas, int width, int height)
{
	if (canvas->width == width && canvas->height == height)
		return 0;
	canvas_free(canvas);
	return canvas_create(canvas, width, height);
}

static int place(const struct drawing *d, const struct box *cell, const struct picture *picture,
		 double squash, int place)
{
	int err = layout_place(d->screen, cell, picture, squash, d->scale, &d->show->scalers[place],
			       d->pipeline->pool);

	return err ? fault_say(d->fault, err, "not enough memory to scale a picture") : 0;
}

static int place_canvas(const struct drawing *d, const struct box *cell,
			const struct canvas *canvas, double squash, int slot)
{
	const struct view whole = {.width = canvas->width, .height = canvas->height, .squash = 1};
	struct picture picture = view_picture(&whole, canvas->pixels, canvas->stride);

	return place(d, cell, &picture, squash, slot);
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
	return place(d, cell, &picture, eye->view.squash, slot);
}

/* Straight into the screen where it goes there pixel by pixel. */
static int draw_after(const struct drawing *d, const struct box *cell, int slot)
{
	const struct eye *eye = &d->eyes->background;
	struct canvas *after = &d->show->after;
	struct picture background;
	struct box box;
	int err;

	if (!eye_has_picture(eye)) {
		layout_black(d->screen, cell);
		return 0;
	}
	background = eye_picture(eye);
	box = layout_box(cell, background.width, background.height, eye->view.squash, d->scale);
	if (layout_in_place(cell, &box, background.width, background.height)) {
		layout_border(d->screen, cell, &box);
		return pipeline_composite(d->pipeline, &background,
					  d->screen->pixels + (size_t)box.y * d->screen->stride +
						  (size_t)box.x * 4,
					  d->screen->stride, d->fault);
	}
	err = canvas_fit(after, background.width, background.height);
	if (err)
		return fault_say(d->fault, err, "not enough memory for a picture of %dx%d",
				 background.width, background.height);
	err = pipeline_composite(d->pipeline, &background, after->pixels, after->stride, d->fault);
	return err ? err : place_canvas(d, cell, after, eye->view.squash, slot);
}

static int draw_fisheye(const struct drawing *d, const struct box *cell, int slot)
{
	const struct eye *eye = &d->eyes->fisheye;
	struct canvas *marked = &d->show->marked;
	struct picture picture;
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
	if (d->pipeline->lit)
		marks_draw(marked, &d->pipeline->dome, &d->pipeline->lens,
			   d->pipeline->selection.used);
	return place_canvas(d, cell, marked, eye->view.squash, slot);
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

int show_draw(struct show *show, enum config_show what, enum config_scale scale,
	      struct pipeline *pipeline, const struct eyes *eyes,
	      const struct display_buffer *screen, struct fault *fault)
{
	struct drawing d = {show, pipeline, eyes, screen, scale, fault};
	struct box whole = layout_whole(screen);

	switch (what) {
	case SHOW_BEFORE:
		return draw_eye(&d, &whole, &eyes->background, 0);
	case SHOW_FISHEYE:
		return draw_fisheye(&d, &whole, 0);
	case SHOW_SCENE:
		return draw_eye(&d, &whole, &eyes->scene, 0);
	case SHOW_QUAD:
		return draw_quad(&d);
	default:
		return draw_after(&d, &whole, 0);
	}
}
