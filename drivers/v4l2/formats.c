/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <errno.h>

#include "hal/device/camera.h"
#include "hal/frame/frame_decode.h"

/* Where two map to one format, the first is preferred. */
static const struct v4l2_layout layouts[] = {
	{V4L2_PIX_FMT_XBGR32, PIXEL_BGRX, 1},
	{V4L2_PIX_FMT_ABGR32, PIXEL_BGRX, 1},
	{V4L2_PIX_FMT_BGR32, PIXEL_BGRX, 1},
	{V4L2_PIX_FMT_BGR24, PIXEL_BGR24, 1},
	{V4L2_PIX_FMT_RGB24, PIXEL_RGB24, 1},
	{V4L2_PIX_FMT_YUYV, PIXEL_YUYV, 1},
	{V4L2_PIX_FMT_UYVY, PIXEL_UYVY, 1},
	{V4L2_PIX_FMT_YVYU, PIXEL_YVYU, 1},
	{V4L2_PIX_FMT_NV16, PIXEL_NV16, 1},
	{V4L2_PIX_FMT_NV12, PIXEL_NV12, 1},
	{V4L2_PIX_FMT_NV12M, PIXEL_NV12, 2},
	{V4L2_PIX_FMT_NV21, PIXEL_NV21, 1},
	{V4L2_PIX_FMT_YUV420, PIXEL_YU12, 1},
	{V4L2_PIX_FMT_YVU420, PIXEL_YV12, 1},
	{V4L2_PIX_FMT_P010, PIXEL_P010, 1},
	{V4L2_PIX_FMT_Y10, PIXEL_Y10, 1},
	{V4L2_PIX_FMT_Y16, PIXEL_Y16, 1},
	{V4L2_PIX_FMT_MJPEG, PIXEL_MJPEG, 1},
	{V4L2_PIX_FMT_JPEG, PIXEL_MJPEG, 1},
	{V4L2_PIX_FMT_GREY, PIXEL_GREY, 1},
	{V4L2_PIX_FMT_H264, PIXEL_H264, 1},
	{V4L2_PIX_FMT_Z16, PIXEL_Z16, 1},
	{V4L2_PIX_FMT_Y12, PIXEL_Y12, 1},
	{V4L2_PIX_FMT_Y14, PIXEL_Y14, 1},
	/* Many sensors of fewer bits send them low in what they call Y16: these are only wished
	 * for. */
	{V4L2_PIX_FMT_Y16, PIXEL_Y10, 1},
	{V4L2_PIX_FMT_Y16, PIXEL_Y12, 1},
	{V4L2_PIX_FMT_Y16, PIXEL_Y14, 1},
};

enum { LAYOUTS = sizeof(layouts) / sizeof(layouts[0]) };

const struct v4l2_layout *v4l2_layout_of(uint32_t fourcc)
{
	for (int i = 0; i < LAYOUTS; i++)
		if (layouts[i].fourcc == fourcc)
			return &layouts[i];
	return NULL;
}

const struct v4l2_layout *v4l2_layout_as(uint32_t fourcc, enum pixel_format wanted)
{
	for (int i = 0; i < LAYOUTS; i++)
		if (layouts[i].fourcc == fourcc && layouts[i].format == wanted)
			return &layouts[i];
	return v4l2_layout_of(fourcc);
}

int v4l2_choose(const struct v4l2_offer *offers, int count, enum pixel_format wanted)
{
	const struct v4l2_layout *best_layout = NULL;
	int best = -1, best_merit = 0;

	for (int i = 0; i < count; i++) {
		const struct v4l2_layout *layout = v4l2_layout_as(offers[i].fourcc, wanted);
		int merit;

		if (!layout || (wanted != PIXEL_NONE && layout->format != wanted))
			continue;
		merit = camera_format_merit(layout->format, offers[i].size, offers[i].rate);
		if (merit > best_merit || (merit == best_merit && layout < best_layout)) {
			best = i;
			best_merit = merit;
			best_layout = layout;
		}
	}
	return best;
}

/* Whether a buffer holds a picture that is compressed, of any length. */
static bool is_compressed(enum pixel_format format)
{
	return format == PIXEL_MJPEG || format == PIXEL_H264;
}

/* Grey does not count as Y'CbCr: cameras fill its whole range, although the kernel's documentation
 * does not say so. */
static bool is_ycbcr(uint32_t fourcc)
{
	const struct v4l2_layout *layout = v4l2_layout_of(fourcc);

	return layout && (pixel_format_is_ycbcr(layout->format) || layout->format == PIXEL_H264);
}

void v4l2_colours(const struct v4l2_pix_format *format, enum colour_matrix *matrix,
		  enum colour_range *range)
{
	const bool large = format->height >= 720;
	unsigned space = format->colorspace, encoding = format->ycbcr_enc;
	unsigned quantization = format->quantization;

	if (space == V4L2_COLORSPACE_DEFAULT)
		space = V4L2_MAP_COLORSPACE_DEFAULT(!large, large);
	if (encoding == V4L2_YCBCR_ENC_DEFAULT)
		encoding = V4L2_MAP_YCBCR_ENC_DEFAULT(space);
	if (quantization == V4L2_QUANTIZATION_DEFAULT)
		quantization = V4L2_MAP_QUANTIZATION_DEFAULT(!is_ycbcr(format->pixelformat), space,
							     encoding);
	*matrix = encoding == V4L2_YCBCR_ENC_601 || encoding == V4L2_YCBCR_ENC_XV601 ? MATRIX_BT601
										     : MATRIX_BT709;
	*range = quantization == V4L2_QUANTIZATION_FULL_RANGE ? RANGE_FULL : RANGE_LIMITED;
}

/* Converts a multi-planar format to the single-planar struct. */
static struct v4l2_pix_format format_flatten(const struct v4l2_format *format)
{
	const struct v4l2_pix_format_mplane *m = &format->fmt.pix_mp;

	if (format->type != V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE)
		return format->fmt.pix;
	return (struct v4l2_pix_format){
		.width = m->width,
		.height = m->height,
		.pixelformat = m->pixelformat,
		.field = m->field,
		.bytesperline = m->plane_fmt[0].bytesperline,
		.colorspace = m->colorspace,
		.ycbcr_enc = m->ycbcr_enc,
		.quantization = m->quantization,
	};
}

static int picture_read_strides(const struct v4l2_format *format, const struct v4l2_pix_format *pix,
				struct v4l2_picture *picture, struct fault *fault)
{
	const struct v4l2_layout *layout = picture->layout;

	for (int i = 0; i < frame_plane_count(layout->format); i++) {
		const size_t least = frame_plane_stride(layout->format, i, picture->width);

		/* In common memory the rows of chroma have their share of the luma's padding. */
		picture->stride[i] = i < layout->memory_planes && i > 0
					     ? format->fmt.pix_mp.plane_fmt[i].bytesperline
					     : pix->bytesperline *
						       frame_plane_stride(layout->format, i, 2) /
						       frame_plane_stride(layout->format, 0, 2);
		/* Some drivers do not tell: rows have no padding then. */
		if (picture->stride[i] == 0)
			picture->stride[i] = least;
		if (picture->stride[i] < least)
			return fault_say(
				fault, -EINVAL,
				"the camera answered with rows of %zu bytes for %d pixels of %s",
				picture->stride[i], picture->width,
				pixel_format_names[layout->format]);
	}
	return 0;
}

static int picture_read_lines(const struct v4l2_pix_format *pix, v4l2_std_id standard,
			      int wanted_height, struct v4l2_picture *picture, struct fault *fault)
{
	const bool alone = pix->field == V4L2_FIELD_TOP || pix->field == V4L2_FIELD_BOTTOM;
	struct frame frame;

	picture->standard = standard;
	picture->rows = picture->height = (int)pix->height;
	picture->lines = v4l2_lines_of(pix->field, standard);
	if (alone && picture->rows == wanted_height)
		picture->lines = (struct v4l2_lines){FIELDS_NONE, false, false};
	if (picture->lines.one_field)
		picture->height *= 2;
	if (picture->lines.fields == FIELDS_NONE)
		return 0;
	frame = (struct frame){.format = picture->layout->format,
			       .height = picture->height,
			       .fields = picture->lines.fields};
	return frame_fields_check(&frame, fault);
}

int v4l2_picture_of(const struct v4l2_format *format, v4l2_std_id standard, int wanted_height,
		    struct v4l2_picture *picture, struct fault *fault)
{
	const struct v4l2_pix_format pix = format_flatten(format);
	const struct v4l2_layout *layout = v4l2_layout_of(pix.pixelformat);
	const bool planar = format->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
	char code[5];
	int err;

	v4l2_fourcc_text(pix.pixelformat, code);
	if (!layout || layout->memory_planes != (planar ? format->fmt.pix_mp.num_planes : 1))
		return fault_say(fault, -ENOTSUP, "the camera answered with the format %s", code);
	if (pix.width < 1 || pix.height < 1 || pix.width > 32768 || pix.height > 32768)
		return fault_say(fault, -EINVAL, "the camera answered with a picture of %ux%u",
				 pix.width, pix.height);
	*picture = (struct v4l2_picture){.layout = layout, .width = (int)pix.width};
	err = picture_read_lines(&pix, standard, wanted_height, picture, fault);
	if (err)
		return err;
	v4l2_colours(&pix, &picture->matrix, &picture->range);
	return is_compressed(layout->format) ? 0
					     : picture_read_strides(format, &pix, picture, fault);
}

int v4l2_bits(uint32_t fourcc)
{
	const struct v4l2_layout *layout = v4l2_layout_of(fourcc);
	size_t bytes = 0;

	if (!layout)
		return 0;
	if (is_compressed(layout->format))
		return layout->format == PIXEL_H264 ? 1 : 4;
	for (int p = 0; p < frame_plane_count(layout->format); p++) /* of two by two pixels */
		bytes += frame_plane_bytes(layout->format, p,
					   frame_plane_stride(layout->format, p, 2), 2);
	return (int)(8 * bytes / 4);
}

static bool plane_is_whole(const struct frame_plane *plane, enum pixel_format format, int index,
			   int width, int height)
{
	const size_t rows = frame_plane_bytes(format, index, 1, height);

	return plane->bytes >=
	       plane->stride * (rows - 1) + frame_plane_stride(format, index, width);
}

bool v4l2_fill_planes(const struct v4l2_picture *picture, const struct v4l2_span memory[2],
		      struct frame_plane planes[FRAME_PLANES])
{
	const enum pixel_format format = picture->layout->format;
	const int count = frame_plane_count(format);
	struct v4l2_span rest = memory[0];

	if (is_compressed(format)) {
		planes[0] = (struct frame_plane){rest.data, 0, rest.bytes};
		return rest.bytes > 0; /* decoding tells whether it is whole */
	}
	for (int p = 0; p < count; p++) {
		const size_t whole = frame_plane_bytes(format, p, picture->stride[p],
						       picture->rows);

		if (p > 0 && p < picture->layout->memory_planes)
			rest = memory[p];
		planes[p] = (struct frame_plane){rest.data, picture->stride[p], rest.bytes};
		if (!plane_is_whole(&planes[p], format, p, picture->width, picture->rows))
			return false;
		if (p + 1 == count || p + 1 < picture->layout->memory_planes)
			continue;
		if (rest.bytes < whole)
			return false;
		planes[p].bytes = whole; /* the next plane follows it */
		rest.data += whole;
		rest.bytes -= whole;
	}
	return true;
}

void v4l2_fourcc_text(uint32_t fourcc, char text[5])
{
	for (int i = 0; i < 4; i++) {
		const char c = (char)(fourcc >> (8 * i) & 0x7f);

		text[i] = c >= ' ' && c < 0x7f ? c : '.';
	}
	text[4] = '\0';
}
