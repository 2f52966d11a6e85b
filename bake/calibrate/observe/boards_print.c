/* SPDX-License-Identifier: MIT */
/*
 * Prints a board on a page, at its true size. Around it stand marks of the world's axes, below it a
 * ruler to check the printer, and the board's name as --board takes it.
 */
#include <cairo-pdf.h>
#include <errno.h>
#include <math.h>
#include <string.h>

#include "bake/calibrate/observe/boards_parts.h"
#include "hal/base/output.h"

#define POINTS_PER_MM (72 / 25.4)
#define MARGIN_MM 8.0  /* most printers cannot print nearer to the edge */
#define FOOTER_MM 14.0 /* of the ruler and the text */
#define RULER_MM 100.0
#define TEXT_MM 3.2
#define AXIS_MM 2.0	/* length of the marks of the world's axes */
#define AXIS_GAP_MM 0.5 /* between them and the ink */

struct sheet {
	const char *name;
	double width_mm, height_mm; /* upright */
};

static const struct sheet sheets[] = {
	{"a4", 210, 297},
	{"a3", 297, 420},
	{"letter", 215.9, 279.4},
};

static const struct sheet *sheet_of(const char *page)
{
	for (size_t i = 0; i < sizeof(sheets) / sizeof(sheets[0]); i++)
		if (!strcmp(sheets[i].name, page))
			return &sheets[i];
	return NULL;
}

int board_page_check(const char *page, struct fault *fault)
{
	if (sheet_of(page))
		return 0;
	return fault_say(fault, -EINVAL, "page \"%s\": expected a4, a3 or letter", page);
}

/* Place of the ink's upper left corner from the board's origin, and the ink's size, in steps. */
struct extent {
	double left, top, width, height;
};

static struct extent extent_of(const struct board *board)
{
	if (board->kind == BOARD_CHESS)
		return (struct extent){-1, -1, board->columns + 1, board->rows + 1};
	return (struct extent){-1, -1, board->columns, board->rows};
}

/* Largest step for which the board fits a sheet of this size, mm. */
static double room_for(const struct extent *extent, double width_mm, double height_mm)
{
	return fmin((width_mm - 2 * MARGIN_MM) / extent->width,
		    (height_mm - 2 * MARGIN_MM - FOOTER_MM) / extent->height);
}

/* Finds the sheet and turns it if the board has more room then. -E2BIG; -EINVAL. */
static int choose_sheet(const struct board *board, const char *page, struct sheet *sheet,
			struct fault *fault)
{
	const struct extent extent = extent_of(board);
	const struct sheet *named = sheet_of(page);
	double upright, turned;
	char name[BOARD_NAME_MAX];

	if (!named)
		return board_page_check(page, fault);
	*sheet = *named;
	upright = room_for(&extent, sheet->width_mm, sheet->height_mm);
	turned = room_for(&extent, sheet->height_mm, sheet->width_mm);
	if (turned > upright) {
		sheet->width_mm = named->height_mm;
		sheet->height_mm = named->width_mm;
	}
	if (board->step_mm <= fmax(upright, turned))
		return 0;
	board_name(board, name);
	return fault_say(fault, -E2BIG, "%s does not fit on %s: expected a step of at most %.1f mm",
			 name, page, floor(10 * fmax(upright, turned)) / 10);
}

/* ---- drawing, in steps from the board's origin ---- */

static void add_marker(cairo_t *cr, const struct board *board, int marker, double x, double y)
{
	const double side = board->marker_mm / board->step_mm;
	const int bits = marker_sets[board->dictionary].bits;
	const double bit = side / (bits + 2), at = (1 - side) / 2;

	/* With the even-odd rule white bits are holes in the black square. */
	cairo_rectangle(cr, x + at, y + at, side, side);
	for (int row = 0; row < bits; row++)
		for (int column = 0; column < bits; column++)
			if (board_marker_bit(board->dictionary, marker, column, row))
				cairo_rectangle(cr, x + at + (column + 1) * bit,
						y + at + (row + 1) * bit, bit, bit);
}

static void add_squares(cairo_t *cr, const struct board *board)
{
	const int more = board->kind == BOARD_CHESS;

	for (int row = 0; row < board->rows + more; row++)
		for (int column = 0; column < board->columns + more; column++) {
			const int marker = board->kind == BOARD_CHARUCO
						   ? board_marker_at(board, column, row)
						   : (column + row) % 2 - 1;

			if (marker < 0)
				cairo_rectangle(cr, column - 1, row - 1, 1, 1);
			else if (board->kind == BOARD_CHARUCO)
				add_marker(cr, board, marker, column - 1, row - 1);
		}
}

/* An arrow head of 2 mm with its letter, whose point is at x, y and points by dx, dy. */
static void draw_axis(cairo_t *cr, const char *letter, double x, double y, double dx, double dy)
{
	cairo_move_to(cr, x, y);
	cairo_line_to(cr, x - AXIS_MM * dx + AXIS_MM / 2 * dy, y - AXIS_MM * dy - AXIS_MM / 2 * dx);
	cairo_line_to(cr, x - AXIS_MM * dx - AXIS_MM / 2 * dy, y - AXIS_MM * dy + AXIS_MM / 2 * dx);
	cairo_close_path(cr);
	cairo_fill(cr);
	cairo_move_to(cr, x + (dx != 0 ? -AXIS_MM : AXIS_MM), y + (dx != 0 ? -AXIS_MM : AXIS_MM));
	cairo_show_text(cr, letter);
}

/*
 * Marks beside the board that tell where the world is when the board lies on the ground: the origin
 * where the lines between opposite marks cross, X to the right, Y up the page. They stand off the
 * ink, which they must not change.
 */
static void draw_axes(cairo_t *cr, const struct extent *extent, double step_mm)
{
	const double left = extent->left * step_mm - AXIS_GAP_MM;
	const double top = extent->top * step_mm - AXIS_GAP_MM;
	const double right = (extent->left + extent->width) * step_mm + AXIS_GAP_MM;
	const double bottom = (extent->top + extent->height) * step_mm + AXIS_GAP_MM;

	cairo_set_line_width(cr, 0.3);
	cairo_move_to(cr, left, 0);
	cairo_rel_line_to(cr, -AXIS_MM, 0);
	cairo_move_to(cr, 0, bottom);
	cairo_rel_line_to(cr, 0, AXIS_MM);
	cairo_stroke(cr);
	cairo_set_font_size(cr, TEXT_MM);
	draw_axis(cr, "X", right + AXIS_MM, 0, 1, 0);
	draw_axis(cr, "Y", 0, top - AXIS_MM, 0, -1);
}

static void draw_board(cairo_t *cr, const struct board *board, const struct sheet *sheet)
{
	const struct extent extent = extent_of(board);
	const double height_mm = extent.height * board->step_mm;
	const double room_mm = sheet->height_mm - FOOTER_MM - 2 * MARGIN_MM;

	cairo_save(cr);
	cairo_translate(cr, (sheet->width_mm - extent.width * board->step_mm) / 2,
			MARGIN_MM + fmax(0, room_mm - height_mm) / 2);
	cairo_translate(cr, -extent.left * board->step_mm, -extent.top * board->step_mm);
	draw_axes(cr, &extent, board->step_mm);
	cairo_scale(cr, board->step_mm, board->step_mm);
	add_squares(cr, board);
	cairo_set_fill_rule(cr, CAIRO_FILL_RULE_EVEN_ODD);
	cairo_fill(cr);
	cairo_restore(cr);
}

static void draw_footer(cairo_t *cr, const struct board *board, const struct sheet *sheet)
{
	const double y = sheet->height_mm - MARGIN_MM - FOOTER_MM / 2;
	char name[BOARD_NAME_MAX];

	board_name(board, name);
	cairo_set_line_width(cr, 0.2);
	cairo_move_to(cr, MARGIN_MM, y);
	cairo_rel_line_to(cr, RULER_MM, 0);
	for (int mm = 0; mm <= (int)RULER_MM; mm += 10) {
		cairo_move_to(cr, MARGIN_MM + mm, y);
		cairo_rel_line_to(cr, 0, mm % 50 ? -1.5 : -3);
	}
	cairo_stroke(cr);
	cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
	cairo_set_font_size(cr, TEXT_MM);
	cairo_move_to(cr, MARGIN_MM + RULER_MM + 2, y);
	cairo_show_text(cr, "100 mm: print at 100 %, then measure");
	cairo_move_to(cr, MARGIN_MM, y + 1.6 * TEXT_MM);
	cairo_show_text(cr, "--board ");
	cairo_show_text(cr, name);
	cairo_show_text(cr, "    On the ground: X and Y of the world cross in its origin.");
}

/* Keeps the errno of a failed write, which Cairo's status does not tell. */
struct pen {
	FILE *stream;
	int err;
};

static cairo_status_t write_bytes(void *context, const unsigned char *bytes, unsigned int count)
{
	struct pen *pen = context;

	errno = 0;
	if (fwrite(bytes, 1, count, pen->stream) == count)
		return CAIRO_STATUS_SUCCESS;
	if (!pen->err)
		pen->err = errno ? -errno : -EIO;
	return CAIRO_STATUS_WRITE_ERROR;
}

static int draw_page(const struct board *board, const struct sheet *sheet, FILE *stream)
{
	struct pen pen = {.stream = stream};
	cairo_surface_t *surface = cairo_pdf_surface_create_for_stream(
		write_bytes, &pen, sheet->width_mm * POINTS_PER_MM,
		sheet->height_mm * POINTS_PER_MM);
	cairo_t *cr = cairo_create(surface);
	cairo_status_t status;

	cairo_scale(cr, POINTS_PER_MM, POINTS_PER_MM);
	draw_board(cr, board, sheet);
	draw_footer(cr, board, sheet);
	status = cairo_status(cr);
	cairo_destroy(cr);
	cairo_surface_finish(surface);
	if (!status)
		status = cairo_surface_status(surface);
	cairo_surface_destroy(surface);
	if (pen.err)
		return pen.err;
	return status == CAIRO_STATUS_NO_MEMORY ? -ENOMEM : status ? -EIO : 0;
}

int board_print(const struct board *board, const char *page, const char *path, struct fault *fault)
{
	struct output out = {.stream = NULL};
	struct sheet sheet = sheets[0];
	int err = choose_sheet(board, page, &sheet, fault);

	if (err)
		return err;
	err = output_open(&out, path, fault);
	if (err)
		return err;
	err = draw_page(board, &sheet, out.stream);
	if (err)
		fault_say(fault, err, "%s: cannot be written: %s", path, strerror(-err));
	else
		err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}
