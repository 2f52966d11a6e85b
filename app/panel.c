#include "app/panel.h"

#include <errno.h>

#if WITH_CAIRO

#include <cairo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/utf8.h"
#include "hal/frame.h"

#define FONT "DejaVu Sans"
#define LEAST_PX 9 /* smaller letters cannot be read */
#define LINES_MAX 40
#define SEPARATOR "\u00b7"

/* Luminances far apart, so that hue carries nothing that is not said otherwise as well. */
static const double back_rgb[3] = {0.06, 0.07, 0.09};
static const double edge_rgb[3] = {0.45, 0.47, 0.50};
static const double text_rgb[3] = {0.95, 0.95, 0.93};
static const double mark_rgb[3] = {1.00, 0.78, 0.20};

/* A text as glyphs along one line, which begins at 0. */
struct run {
	cairo_glyph_t glyph[PANEL_TEXT_MAX + 1]; /* one a character, and one where it ends */
	const char *at[PANEL_TEXT_MAX];		 /* where each character stands in the text */
	int count;
};

struct line {
	int text, first, count; /* glyphs of a text */
	double width;
};

/* Texts in lines of one size. */
struct setting {
	const char *texts[PANEL_TEXTS_MAX];
	int text_count;
	int marked; /* so many texts have a mark */
	int size_px;
	int line_px;	 /* from a line to the next */
	int ascent_px;	 /* from its upper edge to where letters stand */
	int pad, indent; /* around all; before each line */
	int room;	 /* for a line */
	double widest;	 /* text, were it not broken */
	struct line lines[LINES_MAX];
	int count;
};

struct panel {
	enum panel_kind kind;
	struct canvas canvas;
	cairo_surface_t *surface; /* on the canvas's memory */
	cairo_t *cairo;
	int width, height; /* of the box in the canvas; 0: nothing to see */
	struct run run;
	struct setting setting;
	struct panel_room room; /* for which the setting was made */
	char more[32];
};

/* ---- memory ---- */

static void let_go(struct panel *panel)
{
	if (panel->cairo)
		cairo_destroy(panel->cairo);
	if (panel->surface)
		cairo_surface_destroy(panel->surface);
	panel->cairo = NULL;
	panel->surface = NULL;
	canvas_free(&panel->canvas);
}

static void set_font(cairo_t *cairo)
{
	cairo_font_options_t *options = cairo_font_options_create();

	/* Whole pixels: letters look the same wherever they stand. No colour fringes: what a screen
	 * behind a scaler does with subpixels is not known. */
	cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_ON);
	cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_SLIGHT);
	cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
	cairo_set_font_options(cairo, options);
	cairo_font_options_destroy(options);
	cairo_select_font_face(cairo, FONT, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
}

/* A canvas of at least this size. */
static int fit(struct panel *panel, int width, int height)
{
	struct canvas *canvas = &panel->canvas;
	int err;

	if (panel->cairo && canvas->width >= width && canvas->height >= height)
		return 0;
	width = width > canvas->width ? width : canvas->width;
	height = height > canvas->height ? height : canvas->height;
	let_go(panel);
	err = canvas_create(canvas, width, height);
	if (err)
		return err;
	panel->surface = cairo_image_surface_create_for_data(canvas->pixels, CAIRO_FORMAT_ARGB32,
							     width, height, (int)canvas->stride);
	panel->cairo = cairo_create(panel->surface);
	if (cairo_status(panel->cairo)) {
		let_go(panel);
		return -ENOMEM;
	}
	set_font(panel->cairo);
	return 0;
}

int panel_create(struct panel **panel, enum panel_kind kind)
{
	struct panel *p = calloc(1, sizeof(*p));

	*panel = p;
	if (!p)
		return -ENOMEM;
	p->kind = kind;
	return 0;
}

void panel_destroy(struct panel *panel)
{
	if (!panel)
		return;
	let_go(panel);
	free(panel);
}

struct picture panel_picture(const struct panel *panel)
{
	return (struct picture){.origin = panel->canvas.pixels,
				.x_step = 4,
				.y_step = (ptrdiff_t)panel->canvas.stride,
				.width = panel->width,
				.height = panel->height};
}

/* ---- setting lines ---- */

static int set_run(struct panel *panel, const char *text)
{
	struct run *run = &panel->run;
	cairo_glyph_t *glyphs = run->glyph;
	int room = PANEL_TEXT_MAX + 1;
	char ended[PANEL_TEXT_MAX + 1];
	size_t length = utf8_copy(ended, PANEL_TEXT_MAX, text);
	cairo_status_t status;

	run->count = 0;
	for (const char *at = text; at < text + length; at += utf8_bytes(at))
		run->at[run->count++] = at;
	/* A blank behind it says where it ends. */
	memcpy(ended + length, " ", 2);
	status = cairo_scaled_font_text_to_glyphs(cairo_get_scaled_font(panel->cairo), 0, 0, ended,
						  (int)length + 1, &glyphs, &room, NULL, NULL,
						  NULL);
	if (glyphs != run->glyph)
		cairo_glyph_free(glyphs);
	return status || glyphs != run->glyph || room != run->count + 1 ? -ENOMEM : 0;
}

static double run_width(const struct run *run, int first, int count)
{
	return run->glyph[first + count].x - run->glyph[first].x;
}

static bool is_blank(const struct run *run, int i)
{
	return *run->at[i] == ' ';
}

static bool is_separator(const struct run *run, int i)
{
	return !strncmp(run->at[i], SEPARATOR, strlen(SEPARATOR));
}

/* How many glyphs from first on go into a line. */
static int line_count(const struct run *run, int first, double room)
{
	int count = 0, word = 0, part = 0;

	while (first + count < run->count && run_width(run, first, count + 1) <= room) {
		if (count && is_blank(run, first + count)) {
			word = count;
			if (is_separator(run, first + count - 1))
				part = count;
		}
		count++;
	}
	if (first + count == run->count)
		return count;
	if (count && is_blank(run, first + count))
		return count;
	count = part ? part : word ? word : count;
	return count ? count : 1;
}

/* Neither blanks nor a separator at the end of a line. */
static int trimmed(const struct run *run, int first, int count)
{
	while (count > 1 &&
	       (is_blank(run, first + count - 1) || is_separator(run, first + count - 1)))
		count--;
	return count;
}

/* Breaks one text into lines. */
static int set_text(struct panel *panel, int text)
{
	struct setting *setting = &panel->setting;
	const struct run *run = &panel->run;
	int err = set_run(panel, setting->texts[text]), first = 0;

	if (err)
		return err;
	setting->widest = fmax(setting->widest, run_width(run, 0, run->count));
	while (first < run->count && setting->count < LINES_MAX) {
		int count = line_count(run, first, setting->room);
		int shown = trimmed(run, first, count);

		setting->lines[setting->count++] = (struct line){text, first, shown,
								 run_width(run, first, shown)};
		first += count;
		while (first < run->count && is_blank(run, first))
			first++;
	}
	return 0;
}

static int set_lines(struct panel *panel, int size_px)
{
	struct setting *setting = &panel->setting;
	cairo_font_extents_t font;
	int err = 0;

	cairo_set_font_size(panel->cairo, size_px);
	cairo_font_extents(panel->cairo, &font);
	setting->size_px = size_px;
	setting->line_px = (int)ceil(font.height);
	setting->ascent_px = (int)ceil(font.ascent);
	setting->pad = (size_px + 1) / 3;
	setting->indent = setting->marked ? size_px * 3 / 2 : 0;
	setting->room = panel->room.width - setting->indent - 4 * setting->pad;
	setting->widest = setting->count = 0;
	for (int i = 0; i < setting->text_count && !err; i++)
		err = set_text(panel, i);
	return err;
}

static int height_px(const struct setting *setting)
{
	return setting->count * setting->line_px + 2 * setting->pad;
}

static bool is_too_high(const struct panel *panel)
{
	return height_px(&panel->setting) > panel->room.height;
}

/* Each text on a line of its own, in letters at least three quarters as large as wanted. -ERANGE:
 * not possible. */
static int set_unbroken(struct panel *panel)
{
	struct setting *setting = &panel->setting;
	int size = panel->room.size_px, least = size * 3 / 4, err;

	while (size >= least && size >= LEAST_PX) {
		err = set_lines(panel, size);
		if (err)
			return err;
		if (setting->widest <= setting->room && !is_too_high(panel))
			return 0;
		size = (int)fmin(size - 1, size * (setting->room / setting->widest) + 1);
	}
	return -ERANGE;
}

static int set_broken(struct panel *panel)
{
	for (int size = panel->room.size_px; size >= LEAST_PX; size--) {
		int err = set_lines(panel, size);

		if (err)
			return err;
		if (!is_too_high(panel))
			return 0;
	}
	return -ERANGE;
}

/* As many as there is room for, and how many more there are. */
static int set_some(struct panel *panel)
{
	struct setting *setting = &panel->setting;
	int all = setting->text_count, err;

	for (int shown = all - 1; shown >= 1; shown--) {
		snprintf(panel->more, sizeof(panel->more), "and %d more", all - shown);
		setting->texts[shown] = panel->more;
		setting->text_count = shown + 1;
		setting->marked = setting->marked ? shown : 0;
		err = set_lines(panel, LEAST_PX);
		if (err || !is_too_high(panel))
			return err;
	}
	return -ERANGE;
}

/* The first text as far as there is room. */
static int set_part(struct panel *panel)
{
	struct setting *setting = &panel->setting;
	int err;

	setting->text_count = 1;
	err = set_lines(panel, LEAST_PX);
	while (setting->count && is_too_high(panel))
		setting->count--;
	return err;
}

/* In the size of the last time, and in no more lines, so that a strip stands still while its
 * figures change. */
static int set_again(struct panel *panel)
{
	int lines = panel->setting.count;
	int err = set_lines(panel, panel->setting.size_px);

	return err ? err : panel->setting.count > lines ? -ERANGE : 0;
}

static int set(struct panel *panel, bool again)
{
	int err = again ? set_again(panel) : -ERANGE;

	if (err == -ERANGE)
		err = set_unbroken(panel);
	if (err == -ERANGE)
		err = set_broken(panel);
	if (err == -ERANGE)
		err = set_some(panel);
	if (err == -ERANGE)
		err = set_part(panel);
	return err;
}

/* ---- painting ---- */

static void set_colour(cairo_t *cairo, const double rgb[3])
{
	cairo_set_source_rgb(cairo, rgb[0], rgb[1], rgb[2]);
}

/* A box with an edge: all around, or above a strip. */
static void paint_box(const struct panel *panel)
{
	cairo_t *cairo = panel->cairo;
	double edge = fmax(1, panel->setting.size_px / 16);
	bool strip = panel->kind == PANEL_STRIP;
	double side = strip ? 0 : edge, below = strip ? 0 : edge;

	set_colour(cairo, edge_rgb);
	cairo_rectangle(cairo, 0, 0, panel->width, panel->height);
	cairo_fill(cairo);
	set_colour(cairo, back_rgb);
	cairo_rectangle(cairo, side, edge, panel->width - 2 * side, panel->height - edge - below);
	cairo_fill(cairo);
}

/* A triangle with an exclamation mark cut out, as high as a capital letter. */
static void paint_mark(cairo_t *cairo, double x, double base, double size)
{
	double high = 0.8 * size, half = 0.47 * size, middle = x + half;

	set_colour(cairo, mark_rgb);
	cairo_move_to(cairo, middle, base - high);
	cairo_line_to(cairo, middle + half, base);
	cairo_line_to(cairo, middle - half, base);
	cairo_close_path(cairo);
	cairo_fill(cairo);
	set_colour(cairo, back_rgb);
	cairo_rectangle(cairo, middle - 0.05 * size, base - 0.55 * size, 0.1 * size, 0.3 * size);
	cairo_rectangle(cairo, middle - 0.05 * size, base - 0.18 * size, 0.1 * size, 0.1 * size);
	cairo_fill(cairo);
}

static int paint_lines(struct panel *panel)
{
	const struct setting *setting = &panel->setting;
	const struct run *run = &panel->run;
	int current = -1, base = setting->pad + setting->ascent_px;

	for (int i = 0; i < setting->count; i++, base += setting->line_px) {
		const struct line *line = &setting->lines[i];
		double x = 2 * setting->pad;

		if (line->text != current) {
			int err = set_run(panel, setting->texts[line->text]);

			if (err)
				return err;
			current = line->text;
		}
		if (line->first == 0 && line->text < setting->marked)
			paint_mark(panel->cairo, x, base, setting->size_px);
		set_colour(panel->cairo, text_rgb);
		cairo_save(panel->cairo);
		cairo_translate(panel->cairo, x + setting->indent - run->glyph[line->first].x,
				base);
		cairo_show_glyphs(panel->cairo, run->glyph + line->first, line->count);
		cairo_restore(panel->cairo);
	}
	return 0;
}

static int box_width(const struct panel *panel)
{
	const struct setting *setting = &panel->setting;
	double widest = 0;

	if (panel->kind == PANEL_STRIP)
		return panel->room.width;
	for (int i = 0; i < setting->count; i++)
		widest = fmax(widest, setting->lines[i].width);
	return (int)fmin(panel->room.width, ceil(widest) + setting->indent + 4 * setting->pad);
}

static int paint(struct panel *panel)
{
	int err = fit(panel, box_width(panel), height_px(&panel->setting));

	if (err)
		return err;
	panel->width = box_width(panel);
	panel->height = height_px(&panel->setting);
	cairo_set_font_size(panel->cairo, panel->setting.size_px);
	paint_box(panel);
	err = paint_lines(panel);
	cairo_surface_flush(panel->surface);
	return err ? err : cairo_status(panel->cairo) ? -ENOMEM : 0;
}

int panel_draw(struct panel *panel, const char (*texts)[PANEL_TEXT_MAX], int count,
	       const struct panel_room *room)
{
	struct setting *setting = &panel->setting;
	bool again = panel->kind == PANEL_STRIP && panel->width && count == setting->text_count &&
		     !memcmp(room, &panel->room, sizeof(*room));
	int err;

	panel->width = panel->height = 0;
	if (count < 1 || room->width < 1 || room->height < 1)
		return 0;
	setting->text_count = count < PANEL_TEXTS_MAX ? count : PANEL_TEXTS_MAX;
	setting->marked = panel->kind == PANEL_WARNING ? setting->text_count : 0;
	for (int i = 0; i < setting->text_count; i++)
		setting->texts[i] = texts[i];
	panel->room = *room;
	err = fit(panel, 1, 1); /* letters are measured on it */
	if (!err)
		err = set(panel, again);
	if (!err && setting->count)
		err = paint(panel);
	if (err)
		panel->width = panel->height = 0;
	return err;
}

#else

int panel_create(struct panel **panel, enum panel_kind kind)
{
	(void)kind;
	*panel = NULL;
	return -ENOTSUP;
}

int panel_draw(struct panel *panel, const char (*texts)[PANEL_TEXT_MAX], int count,
	       const struct panel_room *room)
{
	(void)panel;
	(void)texts;
	(void)count;
	(void)room;
	return -ENOTSUP;
}

struct picture panel_picture(const struct panel *panel)
{
	(void)panel;
	return (struct picture){.width = 0};
}

void panel_destroy(struct panel *panel)
{
	(void)panel;
}

#endif
