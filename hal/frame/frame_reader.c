/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame_reader.h"

#include <errno.h>
#include <libyuv.h>
#include <stddef.h>
#include <string.h>

#include "hal/frame/depth.h"

/* ---- rows of rarer formats, repacked as those of NV12 and of grey ---- */

static const uint8_t *row_of(const struct frame *frame, int plane, int y)
{
	return frame->planes[plane].data + (size_t)y * frame->planes[plane].stride;
}

static unsigned word_at(const uint8_t *words, int i)
{
	return words[2 * i] | (unsigned)words[2 * i + 1] << 8;
}

/* Limited range of ten bits is four times that of eight (BT.709, table 4). */
static uint8_t ten_to_eight(unsigned word)
{
	const unsigned rounded = ((word >> 6) + 2) >> 2;

	return (uint8_t)(rounded < 255 ? rounded : 255);
}

/* Cb and Cr of half as many pixels, in planes of their own. */
static void interleave(const uint8_t *cb, const uint8_t *cr, int pairs, uint8_t *cbcr)
{
	for (int i = 0; i < pairs; i++) {
		cbcr[2 * i] = cb[i];
		cbcr[2 * i + 1] = cr[i];
	}
}

static void repack_yvyu(const uint8_t *from, int count, int pairs, uint8_t *luma, uint8_t *cbcr)
{
	for (int i = 0; i < count; i++)
		luma[i] = from[2 * i];
	for (int i = 0; i < pairs; i++) {
		cbcr[2 * i] = from[4 * i + 3];
		cbcr[2 * i + 1] = from[4 * i + 1];
	}
}

static void repack_p010(const uint8_t *words, const uint8_t *chroma, int count, int pairs,
			uint8_t *luma, uint8_t *cbcr)
{
	for (int i = 0; i < count; i++)
		luma[i] = ten_to_eight(word_at(words, i));
	for (int i = 0; i < 2 * pairs; i++)
		cbcr[i] = ten_to_eight(word_at(chroma, i));
}

/* Repacks a part of a row of any Y'CbCr format: count bytes of luma, and as many of Cb and Cr in
 * turn (one more if count is odd). x is even. Ten bits are rounded to eight. */
static void frame_repack_ycbcr(const struct frame *frame, int x, int y, int count, uint8_t *luma,
			       uint8_t *cbcr)
{
	const enum pixel_format format = frame->format;
	const int pairs = (count + 1) / 2, half = x / 2;
	const uint8_t *row = row_of(frame, 0, y) + frame_plane_stride(format, 0, x);
	const int down = pixel_format_halves_rows(format) ? y / 2 : y;
	const uint8_t *chroma = NULL;

	if (frame_plane_count(format) > 1)
		chroma = row_of(frame, 1, down) + frame_plane_stride(format, 1, x);
	switch (format) {
	case PIXEL_YVYU:
		repack_yvyu(row, count, pairs, luma, cbcr);
		return;
	case PIXEL_P010:
		repack_p010(row, chroma, count, pairs, luma, cbcr);
		return;
	case PIXEL_YU12:
		interleave(chroma, row_of(frame, 2, down) + half, pairs, cbcr);
		break;
	case PIXEL_YV12:
		interleave(row_of(frame, 2, down) + half, chroma, pairs, cbcr);
		break;
	case PIXEL_NV21:
		for (int i = 0; i < pairs; i++) {
			cbcr[2 * i] = chroma[2 * i + 1];
			cbcr[2 * i + 1] = chroma[2 * i];
		}
		break;
	default: /* NV12, NV16 */
		memcpy(cbcr, chroma, 2 * (size_t)pairs);
	}
	memcpy(luma, row, (size_t)count);
}

/* The same of PIXEL_Y10 to PIXEL_Y16, and of PIXEL_Z16. White stays white: the greatest word
 * becomes 255, and depths of 8191 and more. */
static void frame_repack_grey(const struct frame *frame, int x, int y, int count, uint8_t *grey)
{
	static const uint16_t whites[PIXEL_FORMAT_COUNT] = {[PIXEL_Y10] = 1023,
							    [PIXEL_Y12] = 4095,
							    [PIXEL_Y14] = 16383,
							    [PIXEL_Y16] = 65535,
							    [PIXEL_Z16] = 8191};
	const unsigned white = whites[frame->format];
	const uint8_t *words = row_of(frame, 0, y) + 2 * (size_t)x;

	for (int i = 0; i < count; i++) {
		const unsigned word = word_at(words, i);
		const bool beyond = frame->format == PIXEL_Z16 && word > white;

		grey[i] = (uint8_t)(((beyond ? white : word & white) * 255 + white / 2) / white);
	}
}

/* ---- the reader ---- */

enum { PIECE = 512 }; /* pixels; even */

bool frame_is_raw(const struct frame *frame)
{
	return frame->fields == FIELDS_NONE && frame->format > PIXEL_NONE &&
	       frame->format < PIXEL_MJPEG;
}

int frame_reader_open(struct frame_reader *reader, const struct frame *frame,
		      const struct view *view, struct fault *fault)
{
	int err;

	if (!frame_is_raw(frame))
		return fault_say(fault, -ENOTSUP, "frame: not rows that can be read one by one");
	err = frame_check(frame, fault);
	if (err)
		return err;
	if (view->x < 0 || view->y < 0 || view->width < 1 || view->height < 1 ||
	    view->x > frame->width - view->width || view->y > frame->height - view->height)
		return fault_say(fault, -EINVAL, "frame: a view that is not inside of %dx%d",
				 frame->width, frame->height);
	reader->frame = *frame;
	reader->view = *view;
	reader->rows = frame_rows_choose();
	ycbcr_prepare(&reader->ycbcr, frame->matrix, frame->range);
	return 0;
}

struct frame_reader frame_reader_of(const struct picture *picture)
{
	struct frame_reader reader = {
		.frame = {.format = PIXEL_BGRX,
			  .width = picture->width,
			  .height = picture->height,
			  .range = RANGE_FULL},
		.view = {.width = picture->width,
			 .height = picture->height,
			 .hflip = picture->x_step < 0,
			 .vflip = picture->y_step < 0,
			 .squash = 1},
		.rows = frame_rows_choose(),
	};
	struct frame_plane *plane = &reader.frame.planes[0];
	const uint8_t *corner = picture->origin;

	if (reader.view.hflip)
		corner += picture->x_step * (picture->width - 1);
	if (reader.view.vflip)
		corner += picture->y_step * (picture->height - 1);
	plane->data = corner;
	plane->stride = (size_t)(reader.view.vflip ? -picture->y_step : picture->y_step);
	plane->bytes = plane->stride * (size_t)(picture->height - 1) + 4 * (size_t)picture->width;
	return reader;
}

static const uint8_t *row_at(const struct frame *frame, int plane, int y)
{
	return frame->planes[plane].data + (size_t)y * frame->planes[plane].stride;
}

/* Rarer formats, by pieces that stay in the processor's first cache. */
static void read_repacked(const struct frame_reader *r, int x, int y, int count, uint32_t *out)
{
	uint8_t luma[PIECE], cbcr[PIECE];

	for (int done = 0; done < count; done += PIECE) {
		const int n = count - done < PIECE ? count - done : PIECE;

		frame_repack_ycbcr(&r->frame, x + done, y, n, luma, cbcr);
		r->rows->nv12(&r->ycbcr, luma, cbcr, n, out + done);
	}
}

static void read_grey(const struct frame_reader *r, int x, int y, int count, uint32_t *out)
{
	uint8_t grey[PIECE];

	if (r->frame.format == PIXEL_GREY) {
		r->rows->grey(&r->ycbcr, row_at(&r->frame, 0, y) + x, count, out);
		return;
	}
	for (int done = 0; done < count; done += PIECE) {
		const int n = count - done < PIECE ? count - done : PIECE;

		frame_repack_grey(&r->frame, x + done, y, n, grey);
		r->rows->grey(&r->ycbcr, grey, n, out + done);
	}
}

/* Reads formats whose pixels share chroma in pairs; x is even. */
static void read_pairs(const struct frame_reader *r, int x, int y, int count, uint32_t *out)
{
	const struct frame *frame = &r->frame;
	const uint8_t *row = row_at(frame, 0, y);

	if (frame->format == PIXEL_YUYV)
		r->rows->yuyv(&r->ycbcr, row + 2 * (size_t)x, count, out);
	else if (frame->format == PIXEL_UYVY)
		r->rows->uyvy(&r->ycbcr, row + 2 * (size_t)x, count, out);
	else if (frame->format == PIXEL_NV12)
		r->rows->nv12(&r->ycbcr, row + x, row_at(frame, 1, y / 2) + x, count, out);
	else
		read_repacked(r, x, y, count, out);
}

/* Reads the same formats from any x: an odd x needs the second pixel of the pair before. */
static void read_halved(const struct frame_reader *r, int x, int y, int count, uint32_t *out)
{
	if (x % 2) {
		uint32_t pair[2];

		read_pairs(r, x - 1, y, 2, pair);
		*out++ = pair[1];
		x++;
		count--;
	}
	if (count)
		read_pairs(r, x, y, count, out);
}

static void copy_bgrx(const uint8_t *from, int count, uint32_t *out)
{
	memcpy(out, from, 4 * (size_t)count);
	/* The fourth byte of a camera's pixel is undefined. */
	for (int i = 0; i < count; i++)
		out[i] |= UINT32_C(255) << 24;
}

static void read_rgb(const struct frame_reader *r, int x, int y, int count, uint32_t *out)
{
	const uint8_t *row = row_at(&r->frame, 0, y);

	if (r->frame.format == PIXEL_RGB24) /* libyuv's "RAW" */
		RAWToARGB(row + 3 * (size_t)x, 0, (uint8_t *)out, 0, count, 1);
	else if (r->frame.format == PIXEL_BGR24) /* libyuv's "RGB24" */
		RGB24ToARGB(row + 3 * (size_t)x, 0, (uint8_t *)out, 0, count, 1);
	else
		copy_bgrx(row + 4 * (size_t)x, count, out);
	if (r->frame.range == RANGE_LIMITED)
		ycbcr_row_expand(&r->ycbcr, count, out);
}

/* Reads count pixels of a row; x and y count from the upper left corner of the upright view. */
static void read_row(const struct frame_reader *r, int x, int y, int count, uint32_t *out)
{
	const struct view *v = &r->view;
	const int left = v->x + (v->hflip ? v->width - x - count : x);
	const int row = v->y + (v->vflip ? v->height - 1 - y : y);

	if (pixel_format_is_ycbcr(r->frame.format))
		read_halved(r, left, row, count, out);
	else if (r->frame.format >= PIXEL_GREY)
		read_grey(r, left, row, count, out);
	else
		read_rgb(r, left, row, count, out);
	if (v->hflip)
		r->rows->reverse(out, count);
}

void frame_reader_make(const void *context, int x, int y, int width, int height, uint8_t *out,
		       size_t out_stride)
{
	for (int row = 0; row < height; row++)
		read_row(context, x, y + row, width,
			 (uint32_t *)(void *)(out + (size_t)row * out_stride));
}

const uint32_t *frame_reader_row(const struct frame_reader *r, int x, int y, int count,
				 uint32_t *scratch)
{
	const struct view *v = &r->view;
	const uint8_t *pixels;

	if (r->frame.format == PIXEL_BGRX && r->frame.range == RANGE_FULL && !v->hflip) {
		pixels = row_at(&r->frame, 0, v->y + (v->vflip ? v->height - 1 - y : y)) +
			 4 * (size_t)(v->x + x);
		if ((uintptr_t)pixels % 4 == 0)
			return (const uint32_t *)(const void *)pixels;
	}
	read_row(r, x, y, count, scratch);
	return scratch;
}

void frame_reader_prefetch(const struct frame_reader *r, int x, int y, int count)
{
	const struct view *v = &r->view;
	const int left = v->x + (v->hflip ? v->width - x - count : x);
	const int row = v->y + (v->vflip ? v->height - 1 - y : y);
	const uint8_t *from = row_at(&r->frame, 0, row);
	const size_t first = frame_plane_stride(r->frame.format, 0, left);
	const size_t end = frame_plane_stride(r->frame.format, 0, left + count);

	for (size_t i = first; i < end; i += 64)
		__builtin_prefetch(from + i);
}

enum { WORD = 2 }; /* bytes */

/* The whole frame, turned upright. */
static void map_turned(struct depth_map *map, const struct frame *frame, enum picture_turn turn)
{
	const ptrdiff_t stride = (ptrdiff_t)frame->planes[0].stride;
	const ptrdiff_t right = (ptrdiff_t)WORD * (frame->width - 1);
	const ptrdiff_t lower = stride * (frame->height - 1);
	/* Where the turned picture's upper left pixel is, and the steps to its right and down. */
	const struct {
		ptrdiff_t corner, x_step, y_step;
	} turned[PICTURE_TURN_COUNT] = {
		[PICTURE_UPRIGHT] = {0, WORD, stride},
		[PICTURE_TURN_90] = {lower, -stride, WORD},
		[PICTURE_TURN_180] = {lower + right, -WORD, -stride},
		[PICTURE_TURN_270] = {right, stride, -WORD},
	};
	const bool sideways = picture_turn_is_sideways(turn);

	map->origin = frame->planes[0].data + turned[turn].corner;
	map->x_step = turned[turn].x_step;
	map->y_step = turned[turn].y_step;
	map->width = sideways ? frame->height : frame->width;
	map->height = sideways ? frame->width : frame->height;
}

int depth_map_of(struct depth_map *map, const struct frame *frame, enum picture_turn turn,
		 const struct view *view, double unit_m, struct fault *fault)
{
	int err;

	if (frame->format != PIXEL_Z16 || frame->fields != FIELDS_NONE)
		return fault_say(fault, -ENOTSUP, "the camera sends %s, expected Z16",
				 pixel_format_names[frame->format]);
	err = frame_check(frame, fault);
	if (err)
		return err;
	map_turned(map, frame, turn);
	if (view->x < 0 || view->y < 0 || view->width < 1 || view->height < 1 ||
	    view->x > map->width - view->width || view->y > map->height - view->height)
		return fault_say(fault, -EINVAL, "a view that is not inside of %dx%d", map->width,
				 map->height);
	map->origin += (view->hflip ? view->x + view->width - 1 : view->x) * map->x_step +
		       (view->vflip ? view->y + view->height - 1 : view->y) * map->y_step;
	map->x_step = view->hflip ? -map->x_step : map->x_step;
	map->y_step = view->vflip ? -map->y_step : map->y_step;
	map->width = view->width;
	map->height = view->height;
	map->unit_m = unit_m;
	return 0;
}

double depth_map_at(const struct depth_map *map, int x, int y)
{
	const uint8_t *word = map->origin + x * map->x_step + y * map->y_step;

	return (word[0] | word[1] << 8) * map->unit_m;
}
