/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/report/report_parts.h"

#include <cairo.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "hal/image/image.h"

#define AREA_HEIGHT_MOST 900
#define TEXT_PX 14
#define PALED 0.5	  /* opacity of white over a photograph */
#define ARROW_MOST 4000.0 /* longest arrow, px: cairo's coordinates end at 2^23 */

/* Copies an 8-bit picture to a new surface of CAIRO_FORMAT_RGB24, which the caller destroys. NULL:
 * out of memory. */
static cairo_surface_t *surface_of_image(const struct image *image)
{
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, image->width,
							      image->height);
	size_t stride;
	unsigned char *data;

	if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
		cairo_surface_destroy(surface);
		return NULL;
	}
	stride = (size_t)cairo_image_surface_get_stride(surface);
	data = cairo_image_surface_get_data(surface);
	for (int y = 0; y < image->height; y++)
		for (int x = 0; x < image->width; x++) {
			const uint8_t *from = image->u8 +
					      3 * ((size_t)y * (size_t)image->width + (size_t)x);
			const uint32_t pixel = (uint32_t)from[0] << 16 | (uint32_t)from[1] << 8 |
					       (uint32_t)from[2];

			memcpy(data + (size_t)y * stride + (size_t)x * 4, &pixel, sizeof(pixel));
		}
	cairo_surface_mark_dirty(surface);
	return surface;
}

static const double inks[][3] = {
	[INK_BLACK] = {0.1, 0.1, 0.1},
	[INK_GREY] = {0.4, 0.4, 0.4},
	[INK_WHITE] = {1, 1, 1},
	[INK_SEEN] = {0.000, 0.447, 0.698},
	[INK_EXPECTED] = {0.1, 0.1, 0.1},
	[INK_RESIDUAL] = {0.000, 0.620, 0.451},
	[INK_OUTLIER] = {0.835, 0.369, 0.000},
	[INK_AXIS_X] = {0.80, 0.05, 0.10},
	[INK_AXIS_Y] = {0.05, 0.50, 0.05},
	[INK_AXIS_Z] = {0.10, 0.20, 0.90},
};

/* ---- sheets ---- */

/* Creates a white sheet. -ENOMEM, -EFBIG. */
static int sheet_begin(struct report_sheet *sheet, int width, int height)
{
	cairo_status_t status;

	*sheet = (struct report_sheet){.width = width, .height = height};
	sheet->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
	sheet->c = cairo_create(sheet->surface);
	status = cairo_surface_status(sheet->surface);
	if (status != CAIRO_STATUS_SUCCESS) {
		sheet_free(sheet);
		return status == CAIRO_STATUS_INVALID_SIZE ? -EFBIG : -ENOMEM;
	}
	cairo_select_font_face(sheet->c, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
			       CAIRO_FONT_WEIGHT_NORMAL);
	cairo_set_font_size(sheet->c, TEXT_PX);
	cairo_set_source_rgb(sheet->c, 1, 1, 1);
	cairo_paint(sheet->c);
	return 0;
}

void sheet_free(struct report_sheet *sheet)
{
	cairo_destroy(sheet->c);
	cairo_surface_destroy(sheet->surface);
	*sheet = (struct report_sheet){.width = 0};
}

int sheet_show(struct report_sheet *sheet, struct report_page *page, const char *name,
	       const char *caption, struct fault *fault)
{
	char path[REPORT_PATH_MAX];
	cairo_status_t status;
	int err = 0;

	report_page_path(page, name, ".png", path);
	status = cairo_surface_write_to_png(sheet->surface, path);
	if (status)
		err = fault_say(fault, -EIO, "%s: %s", path, cairo_status_to_string(status));
	else
		report_page_show(page, name, caption);
	sheet_free(sheet);
	return err;
}

/* ---- where the camera's picture lies ---- */

int sheet_begin_area(struct report_sheet *sheet, struct sheet_area *area, int width, int height)
{
	const int room = SHEET_WIDTH - 2 * SHEET_MARGIN;

	area->scale = fmin((double)room / width, (double)AREA_HEIGHT_MOST / height);
	area->width = width;
	area->height = height;
	area->left = rint((SHEET_WIDTH - area->scale * width) / 2);
	area->top = SHEET_MARGIN;
	return sheet_begin(sheet, SHEET_WIDTH,
			   (int)ceil(area->scale * height) + 2 * SHEET_MARGIN + SHEET_LINE);
}

static void sheet_ink(struct report_sheet *sheet, enum sheet_ink ink, double alpha)
{
	cairo_set_source_rgba(sheet->c, inks[ink][0], inks[ink][1], inks[ink][2], alpha);
}

int sheet_photograph(struct report_sheet *sheet, const struct sheet_area *area,
		     const struct image *photograph)
{
	cairo_surface_t *surface;

	sheet_clip(sheet, area);
	if (!photograph) {
		cairo_set_source_rgb(sheet->c, 0.93, 0.93, 0.93);
		cairo_paint(sheet->c);
		sheet_unclip(sheet);
		return 0;
	}
	surface = surface_of_image(photograph);
	if (!surface) {
		sheet_unclip(sheet);
		return -ENOMEM;
	}
	cairo_translate(sheet->c, area->left, area->top);
	cairo_scale(sheet->c, area->scale, area->scale);
	cairo_set_source_surface(sheet->c, surface, 0, 0);
	cairo_pattern_set_filter(cairo_get_source(sheet->c), CAIRO_FILTER_GOOD);
	cairo_paint(sheet->c);
	sheet_unclip(sheet);
	cairo_surface_destroy(surface);
	sheet_clip(sheet, area);
	sheet_ink(sheet, INK_WHITE, PALED);
	cairo_paint(sheet->c);
	sheet_unclip(sheet);
	return 0;
}

void sheet_clip(struct report_sheet *sheet, const struct sheet_area *area)
{
	cairo_save(sheet->c);
	cairo_rectangle(sheet->c, area->left, area->top, area->scale * area->width,
			area->scale * area->height);
	cairo_clip(sheet->c);
}

void sheet_unclip(struct report_sheet *sheet)
{
	cairo_restore(sheet->c);
}

void sheet_frame(struct report_sheet *sheet, const struct sheet_area *area)
{
	sheet_ink(sheet, INK_GREY, 1);
	cairo_set_line_width(sheet->c, 1);
	cairo_rectangle(sheet->c, area->left - 0.5, area->top - 0.5, area->scale * area->width + 1,
			area->scale * area->height + 1);
	cairo_stroke(sheet->c);
}

bool sheet_place(const struct sheet_area *area, const double px[2], double at[2])
{
	at[0] = area->left + area->scale * px[0];
	at[1] = area->top + area->scale * px[1];
	return fabs(at[0]) < ARROW_MOST && fabs(at[1]) < ARROW_MOST;
}

/* ---- marks ---- */

/* Replaces bytes that are not ASCII: file names need not be UTF-8, and cairo draws nothing more
 * after an invalid text. */
static void sheet_make_plain(char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text >= 0x7f || (unsigned char)*text < 0x20)
			*text = '?';
}

void sheet_text(struct report_sheet *sheet, double x, double y, enum sheet_ink ink,
		const char *format, ...)
{
	char text[256];
	cairo_t *c = sheet->c;
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	sheet_make_plain(text);
	cairo_move_to(c, x, y);
	cairo_text_path(c, text);
	sheet_ink(sheet, INK_WHITE, 0.85);
	cairo_set_line_width(c, 4);
	cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
	cairo_stroke_preserve(c);
	sheet_ink(sheet, ink, 1);
	cairo_fill(c);
}

double sheet_text_width(const struct report_sheet *sheet, const char *text)
{
	cairo_text_extents_t extents;

	cairo_text_extents(sheet->c, text, &extents);
	return extents.x_advance;
}

/* Strokes the path in its colour, over a wider white line. */
static void sheet_stroke(struct report_sheet *sheet, double width, enum sheet_ink ink)
{
	sheet_ink(sheet, INK_WHITE, 0.8);
	cairo_set_line_width(sheet->c, width + 2);
	cairo_stroke_preserve(sheet->c);
	sheet_ink(sheet, ink, 1);
	cairo_set_line_width(sheet->c, width);
	cairo_stroke(sheet->c);
}

void sheet_line(struct report_sheet *sheet, double (*place)[2], int count, double width,
		enum sheet_ink ink)
{
	cairo_move_to(sheet->c, place[0][0], place[0][1]);
	for (int k = 1; k < count; k++)
		cairo_line_to(sheet->c, place[k][0], place[k][1]);
	sheet_stroke(sheet, width, ink);
}

void sheet_ring(struct report_sheet *sheet, const double at[2], double radius, enum sheet_ink ink)
{
	cairo_new_sub_path(sheet->c);
	cairo_arc(sheet->c, at[0], at[1], radius, 0, 2 * M_PI);
	sheet_stroke(sheet, 1.5, ink);
}

void sheet_cross(struct report_sheet *sheet, const double at[2], double radius, enum sheet_ink ink)
{
	cairo_move_to(sheet->c, at[0] - radius, at[1]);
	cairo_line_to(sheet->c, at[0] + radius, at[1]);
	cairo_move_to(sheet->c, at[0], at[1] - radius);
	cairo_line_to(sheet->c, at[0], at[1] + radius);
	sheet_stroke(sheet, 1.2, ink);
}

void sheet_square(struct report_sheet *sheet, const double at[2], double radius, enum sheet_ink ink)
{
	cairo_rectangle(sheet->c, at[0] - radius, at[1] - radius, 2 * radius, 2 * radius);
	sheet_stroke(sheet, 2, ink);
}

void sheet_arrow(struct report_sheet *sheet, const double at[2], const double along[2],
		 enum sheet_ink ink)
{
	const double whole = hypot(along[0], along[1]), head = fmin(6, 0.4 * whole);
	const double shown = fmin(whole, ARROW_MOST);
	double x, y, tip[2];

	if (!(whole > 0.5) || !isfinite(whole))
		return;
	x = along[0] / whole;
	y = along[1] / whole;
	tip[0] = at[0] + shown * x;
	tip[1] = at[1] + shown * y;
	cairo_move_to(sheet->c, at[0], at[1]);
	cairo_line_to(sheet->c, tip[0], tip[1]);
	cairo_move_to(sheet->c, tip[0] - head * (x + 0.5 * y), tip[1] - head * (y - 0.5 * x));
	cairo_line_to(sheet->c, tip[0], tip[1]);
	cairo_line_to(sheet->c, tip[0] - head * (x - 0.5 * y), tip[1] - head * (y + 0.5 * x));
	sheet_stroke(sheet, 1.5, ink);
}
