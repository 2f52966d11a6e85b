/* SPDX-License-Identifier: MIT */
#include "app/view/show.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "app/view/layout.h"

#define LETTER_PX 15 /* of SHOW_GUIDE, on the screen */

/* What drawing any view needs. */
struct show_drawing {
	struct show *show;
	const struct show_request *request;
	const struct show_pictures *pictures;
	const struct display_buffer *screen;
	struct fault *fault;
};

const struct show_needs *show_needs(enum config_show view)
{
	static const struct show_needs needs[SHOW_COUNT] = {
		[SHOW_COMPOSITE] = {.composite = true},
		[SHOW_BEFORE] = {.background = true},
		[SHOW_FISHEYE] = {.fisheye = true},
		[SHOW_SCENE] = {.scene = true},
		[SHOW_QUAD] = {true, true, true, true},
		[SHOW_SPLIT] = {.background = true, .composite = true},
		[SHOW_OFF] = {.composite = false},
		[SHOW_GUIDE] = {.fisheye = true, .composite = true},
	};

	return &needs[view];
}

void show_free(struct show *show)
{
	canvas_free(&show->after);
	canvas_free(&show->marked);
	for (int i = 0; i < 4; i++)
		scaler_free(&show->scalers[i]);
}

/* Takes the size from the camera's mode, if it is open, whether it has sent a frame or not. */
static void fit_camera(struct show_fit *fit, const struct eye *eye)
{
	struct view view = eye->wanted;
	int width, height;

	if (!eye->source || !source_is_open(eye->source))
		return;
	source_size(eye->source, &width, &height);
	if (view_resolve(&view, width, height, NULL))
		return;
	*fit = (struct show_fit){view.width, view.height, view.squash};
}

/* Size of one picture of the view; views of several are larger. */
static struct show_fit fit_one(enum config_show view, const struct eyes *eyes,
			       const struct basis *basis)
{
	struct show_fit fit = {(int)basis->info.width, (int)basis->info.height,
			       eyes->background.wanted.squash};

	if (view == SHOW_FISHEYE)
		fit_camera(&fit, &eyes->fisheye);
	if (view == SHOW_SCENE)
		fit_camera(&fit, &eyes->scene);
	return fit;
}

static int copies_across(enum config_show view)
{
	return view == SHOW_QUAD || view == SHOW_GUIDE ? 2 : 1;
}

static int copies_down(enum config_show view)
{
	return view == SHOW_QUAD ? 2 : 1;
}

struct show_fit show_fit(enum config_show view, const struct eyes *eyes, const struct basis *basis)
{
	struct show_fit fit = fit_one(view, eyes, basis);

	fit.width *= copies_across(view);
	fit.height *= copies_down(view);
	return fit;
}

void show_size(enum config_show view, const struct eyes *eyes, const struct basis *basis,
	       int *width, int *height)
{
	const struct show_fit fit = fit_one(view, eyes, basis);

	*width = fit.width * copies_across(view);
	*height = (int)lrint(fit.height * fit.squash) * copies_down(view);
}

/* ---- where the composite goes ---- */

/* Parts of the screen are fitted whatever is asked for. */
static enum config_scale scale_of(const struct show_request *request)
{
	return request->view == SHOW_QUAD || request->view == SHOW_GUIDE ? SCALE_FIT
									 : request->scale;
}

static struct layout_box composite_cell(const struct show_request *request,
					const struct display_buffer *screen)
{
	switch (request->view) {
	case SHOW_QUAD:
		return layout_quarter(screen, 3);
	case SHOW_GUIDE:
		return layout_half(screen, 0);
	default:
		return layout_whole(screen);
	}
}

static struct layout_box composite_box(const struct show_request *request,
				       const struct show_composite *composite,
				       const struct layout_box *cell)
{
	return layout_box(cell, composite->width, composite->height,
			  composite->squash / request->squash, scale_of(request));
}

static uint8_t *box_pixels(const struct display_buffer *screen, const struct layout_box *box)
{
	return screen->pixels + (size_t)box->y * screen->stride + (size_t)box->x * 4;
}

/* Whether the composite lies in the screen, pixel by pixel and uncut. Those of SHOW_SPLIT
 * and SHOW_GUIDE never do: half of it is not shown, or it is drawn into, and the screen's memory is
 * written once. */
static bool is_in_screen(const struct show_request *request, const struct show_composite *composite,
			 const struct layout_box *cell, const struct layout_box *box)
{
	return request->view != SHOW_SPLIT && request->view != SHOW_GUIDE &&
	       layout_in_place(cell, box, composite->width, composite->height);
}

int show_room(struct show *show, const struct show_request *request,
	      struct show_composite *composite, const struct display_buffer *screen,
	      struct fault *fault)
{
	const struct layout_box cell = composite_cell(request, screen);
	struct layout_box box;
	int err;

	composite->pixels = NULL;
	if (!show_needs(request->view)->composite || !composite->width)
		return 0;
	box = composite_box(request, composite, &cell);
	if (is_in_screen(request, composite, &cell, &box)) {
		composite->pixels = box_pixels(screen, &box);
		composite->stride = screen->stride;
		return 0;
	}
	err = canvas_fit(&show->after, composite->width, composite->height);
	if (err)
		return fault_say(fault, err, "not enough memory for a picture of %dx%d",
				 composite->width, composite->height);
	composite->pixels = show->after.pixels;
	composite->stride = show->after.stride;
	return 0;
}

/* ---- drawing ---- */

static double squash_of(const struct show_drawing *d, double squash)
{
	return squash / d->request->squash;
}

static int say_scaling(const struct show_drawing *d, int err)
{
	return err ? fault_say(d->fault, err, "not enough memory to scale a picture") : 0;
}

static struct picture whole_picture(const uint8_t *pixels, size_t stride, int width, int height)
{
	const struct view whole = {.width = width, .height = height, .squash = 1};

	return view_picture(&whole, pixels, stride);
}

static int place_picture(const struct show_drawing *d, const struct layout_box *cell,
			 const struct picture *picture, double squash, int slot)
{
	return say_scaling(d, layout_place(d->screen, cell, picture, squash_of(d, squash),
					   scale_of(d->request), &d->show->scalers[slot],
					   d->request->pool));
}

static int draw_picture(const struct show_drawing *d, const struct layout_box *cell,
			const struct show_picture *shown, int slot)
{
	if (!shown->picture.width) {
		layout_black(d->screen, cell);
		return 0;
	}
	return place_picture(d, cell, &shown->picture, shown->squash, slot);
}

/* Height of letters in a picture, so that they have LETTER_PX on the screen. */
static double letter_px(int picture_height, const struct layout_box *box)
{
	return (double)LETTER_PX * picture_height / box->height;
}

/* Draws the guide into the composite, which show_room() has put into memory of its own. */
static void draw_ground(const struct show_drawing *d, const struct layout_box *box)
{
	const struct show_composite *composite = &d->pictures->composite;
	const struct show_guide *guide = &d->pictures->guide;

	if (d->request->view == SHOW_GUIDE && guide->camera &&
	    guide->camera->width == composite->width && guide->camera->height == composite->height)
		guide_draw_ground(&d->show->after, guide->camera, guide->coverage, &guide->lamps,
				  letter_px(composite->height, box));
}

/* A composite that show_room() put into the screen needs its border only. */
static int draw_composite(const struct show_drawing *d, int slot)
{
	const struct show_composite *composite = &d->pictures->composite;
	const struct layout_box cell = composite_cell(d->request, d->screen);
	struct picture picture;
	struct layout_box box;

	if (!composite->width) {
		layout_black(d->screen, &cell);
		return 0;
	}
	box = composite_box(d->request, composite, &cell);
	if (is_in_screen(d->request, composite, &cell, &box)) {
		layout_border(d->screen, &cell, &box);
		return 0;
	}
	draw_ground(d, &box);
	picture = whole_picture(composite->pixels, composite->stride, composite->width,
				composite->height);
	return place_picture(d, &cell, &picture, composite->squash, slot);
}

static int draw_split(const struct show_drawing *d)
{
	const struct layout_box cell = layout_whole(d->screen);
	const struct picture *background = &d->pictures->background.picture;
	const struct show_composite *composite = &d->pictures->composite;
	struct scaler *scaler = &d->show->scalers[0];
	struct picture after;
	struct layout_box box;
	struct layout_span line;
	int err;

	if (!composite->width) {
		layout_black(d->screen, &cell);
		return 0;
	}
	after = whole_picture(composite->pixels, composite->stride, composite->width,
			      composite->height);
	box = composite_box(d->request, composite, &cell);
	line = layout_line(&cell, &box, d->request->split);
	layout_border(d->screen, &cell, &box);
	layout_draw_line(d->screen, &cell, &box, &line);
	err = layout_fill(d->screen, &cell, &box, &(struct layout_span){cell.x, line.from},
			  background, scaler, d->request->pool);
	if (!err)
		err = layout_fill(d->screen, &cell, &box,
				  &(struct layout_span){line.to, cell.x + cell.width}, &after,
				  scaler, d->request->pool);
	return say_scaling(d, err);
}

static int draw_fisheye(const struct show_drawing *d, const struct layout_box *cell, int slot)
{
	const struct show_picture *fisheye = &d->pictures->fisheye;
	const struct show_marks *marks = &d->pictures->marks;
	const int width = fisheye->picture.width, height = fisheye->picture.height;
	struct canvas *marked = &d->show->marked;
	struct picture picture;
	struct layout_box box;
	int err;

	if (!width) {
		layout_black(d->screen, cell);
		return 0;
	}
	err = canvas_fit(marked, width, height);
	if (err)
		return fault_say(d->fault, err, "not enough memory for a picture of %dx%d", width,
				 height);
	picture_copy(&fisheye->picture, marked->pixels, marked->stride);
	box = layout_box(cell, width, height, squash_of(d, fisheye->squash), scale_of(d->request));
	if (marks->dome && d->request->view == SHOW_GUIDE)
		guide_draw_sky(marked, marks->lens, marks->dome, marks->radiance,
			       &d->pictures->guide.lamps, letter_px(height, &box));
	else if (marks->dome)
		marks_draw(marked, marks->dome, marks->lens, marks->used,
			   mark_side_px(height, box.height));
	picture = whole_picture(marked->pixels, marked->stride, width, height);
	return place_picture(d, cell, &picture, fisheye->squash, slot);
}

static int draw_quad(const struct show_drawing *d)
{
	struct layout_box cell[3];
	int err;

	for (int i = 0; i < 3; i++)
		cell[i] = layout_quarter(d->screen, i);
	err = draw_picture(d, &cell[0], &d->pictures->scene, 0);
	if (!err)
		err = draw_fisheye(d, &cell[1], 1);
	if (!err)
		err = draw_picture(d, &cell[2], &d->pictures->background, 2);
	if (!err)
		err = draw_composite(d, 3);
	return err;
}

static int draw_guide(const struct show_drawing *d)
{
	const struct layout_box cell = layout_half(d->screen, 1);
	int err = draw_composite(d, 0);

	return err ? err : draw_fisheye(d, &cell, 1);
}

static int draw_view(const struct show_drawing *d)
{
	const struct layout_box whole = layout_whole(d->screen);

	switch (d->request->view) {
	case SHOW_BEFORE:
		return draw_picture(d, &whole, &d->pictures->background, 0);
	case SHOW_FISHEYE:
		return draw_fisheye(d, &whole, 0);
	case SHOW_SCENE:
		return draw_picture(d, &whole, &d->pictures->scene, 0);
	case SHOW_QUAD:
		return draw_quad(d);
	case SHOW_SPLIT:
		return draw_split(d);
	case SHOW_GUIDE:
		return draw_guide(d);
	case SHOW_OFF:
		layout_black(d->screen, &whole);
		return 0;
	default:
		return draw_composite(d, 0);
	}
}

int show_draw(struct show *show, const struct show_request *request,
	      const struct show_pictures *pictures, const struct display_buffer *screen,
	      struct fault *fault)
{
	const struct show_drawing d = {.show = show,
				       .request = request,
				       .pictures = pictures,
				       .screen = screen,
				       .fault = fault};
	int err = draw_view(&d);

	if (err || !request->overlay)
		return err;
	err = overlay_draw(request->overlay, screen);
	return err ? fault_say(fault, err, "not enough memory for text on the screen") : 0;
}
