/* SPDX-License-Identifier: MIT */
#include "hal/jpeg/jpeg_decoder.h"

#include <errno.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h> /* jpeglib.h needs it */
#include <stdlib.h>
#include <string.h>

#include <jerror.h>
#include <jpeglib.h>

/* A hostile progressive picture may hold scans without end. Real ones have about ten. */
#define SCANS_MAX 500

struct jpeg_decoder {
	struct jpeg_decompress_struct info;
	struct jpeg_error_mgr errors;
	struct jpeg_progress_mgr progress;
	jmp_buf failed;
	bool cut;		      /* the data ended before an end marker */
	char damage[JMSG_LENGTH_MAX]; /* what is missing or made up; empty: nothing */
	uint8_t *row;		      /* a row that is wider than what is wanted, or CMYK */
	size_t row_bytes;
};

static struct jpeg_decoder *jpeg_of(j_common_ptr info)
{
	return info->client_data;
}

static void jpeg_fail(j_common_ptr info)
{
	struct jpeg_decoder *jpeg = jpeg_of(info);

	info->err->format_message(info, jpeg->damage);
	longjmp(jpeg->failed, 1);
}

/* Whether the picture is whole in spite of a warning. Stray bytes before a restart marker are the
 * rest of an interval that was not decoded. */
static bool is_harmless(const struct jpeg_error_mgr *errors)
{
	switch (errors->msg_code) {
	case JWRN_EXTRANEOUS_DATA:
		return errors->msg_parm.i[1] < JPEG_RST0 || errors->msg_parm.i[1] > JPEG_RST0 + 7;
	case JWRN_ADOBE_XFORM:
	case JWRN_BOGUS_ICC:
	case JWRN_JFIF_MAJOR:
	case JWRN_JPEG_EOF: /* where data are missing, another warning follows */
	case JWRN_NOT_SEQUENTIAL:
		return true;
	default:
		return false;
	}
}

/* A negative level is a warning. */
static void jpeg_warn(j_common_ptr info, int level)
{
	struct jpeg_decoder *jpeg = jpeg_of(info);

	if (level >= 0)
		return;
	jpeg->cut |= info->err->msg_code == JWRN_JPEG_EOF;
	if (!jpeg->damage[0] && !is_harmless(info->err))
		info->err->format_message(info, jpeg->damage);
}

static void jpeg_count_scans(j_common_ptr info)
{
	if (jpeg_of(info)->info.input_scan_number > SCANS_MAX)
		ERREXIT(info, JERR_BAD_PROGRESSION);
}

int jpeg_decoder_create(struct jpeg_decoder **jpeg)
{
	struct jpeg_decoder *j = calloc(1, sizeof(*j));

	*jpeg = NULL;
	if (!j)
		return -ENOMEM;
	j->info.err = jpeg_std_error(&j->errors);
	j->errors.error_exit = jpeg_fail;
	j->errors.emit_message = jpeg_warn;
	j->info.client_data = j;
	if (setjmp(j->failed)) {
		jpeg_decoder_destroy(j);
		return -ENOMEM;
	}
	jpeg_create_decompress(&j->info);
	j->progress.progress_monitor = jpeg_count_scans;
	j->info.progress = &j->progress;
	*jpeg = j;
	return 0;
}

void jpeg_decoder_destroy(struct jpeg_decoder *jpeg)
{
	if (!jpeg)
		return;
	jpeg_destroy_decompress(&jpeg->info);
	free(jpeg->row);
	free(jpeg);
}

/* Offset of the first start marker; bytes if there is none. */
static size_t find_start(const uint8_t *data, size_t bytes)
{
	for (size_t i = 0; i + 2 <= bytes; i++) {
		if (data[i] == 0xff && data[i + 1] == 0xd8)
			return i;
	}
	return bytes;
}

static int jpeg_refuse(const struct jpeg_decoder *jpeg, const char *what, struct fault *fault)
{
	const bool memory = jpeg->errors.msg_code == JERR_OUT_OF_MEMORY;

	return fault_say(fault, memory ? -ENOMEM : -EBADMSG, "%s: %s", what, jpeg->damage);
}

/* data begins with the start marker. A function of its own: longjmp() may spoil variables that
 * change. */
static int jpeg_decoder_read_header(struct jpeg_decoder *jpeg, const uint8_t *data, size_t bytes,
				    int *width, int *height, struct fault *fault)
{
	if (setjmp(jpeg->failed))
		return jpeg_refuse(jpeg, "not a JPEG picture", fault);
	jpeg_abort_decompress(&jpeg->info);
	jpeg->cut = false;
	jpeg->damage[0] = '\0';
	jpeg_mem_src(&jpeg->info, data, bytes);
	jpeg_read_header(&jpeg->info, TRUE);
	*width = (int)jpeg->info.image_width;
	*height = (int)jpeg->info.image_height;
	return 0;
}

int jpeg_decoder_open(struct jpeg_decoder *jpeg, const uint8_t *data, size_t bytes, int *width,
		      int *height, struct fault *fault)
{
	const size_t start = find_start(data, bytes);

	if (start == bytes)
		return fault_say(fault, -EBADMSG, "not a JPEG picture: no start marker in it");
	return jpeg_decoder_read_header(jpeg, data + start, bytes - start, width, height, fault);
}

/* Converts CMYK to R'G'B' in place of a profile: light that each ink leaves over. Adobe's programs
 * store 255 - ink. */
static void read_cmyk(const uint8_t *cmyk, bool adobe, enum jpeg_pixels kind, int count,
		      uint8_t *out)
{
	for (int x = 0; x < count; x++, cmyk += 4) {
		const unsigned black = adobe ? cmyk[3] : 255U - cmyk[3];
		uint8_t rgb[3];

		for (int c = 0; c < 3; c++) {
			const unsigned ink = adobe ? cmyk[c] : 255U - cmyk[c];

			rgb[c] = (uint8_t)((ink * black + 127) / 255);
		}
		for (int c = 0; c < 3; c++)
			*out++ = rgb[kind == JPEG_BGRX ? 2 - c : c];
		if (kind == JPEG_BGRX)
			*out++ = 255;
	}
}

static bool jpeg_grow_row(struct jpeg_decoder *jpeg, size_t bytes)
{
	uint8_t *row;

	if (jpeg->row_bytes >= bytes)
		return true;
	row = realloc(jpeg->row, bytes);
	if (!row)
		return false;
	jpeg->row = row;
	jpeg->row_bytes = bytes;
	return true;
}

static void read_rows(struct jpeg_decoder *jpeg, enum jpeg_pixels kind, uint8_t *pixels,
		      size_t stride, int width, int height)
{
	const bool cmyk = jpeg->info.out_color_space == JCS_CMYK;
	const bool wider = jpeg->info.output_width > (JDIMENSION)width;

	for (int y = 0; y < height; y++) {
		uint8_t *out = pixels + (size_t)y * stride;
		JSAMPROW row = cmyk || wider ? jpeg->row : out;

		jpeg_read_scanlines(&jpeg->info, &row, 1);
		if (cmyk)
			read_cmyk(row, jpeg->info.saw_Adobe_marker, kind, width, out);
		else if (wider)
			memcpy(out, row, (size_t)width * (kind == JPEG_BGRX ? 4 : 3));
	}
}

/* A progressive picture whose end is missing may lack whole scans without a warning. coef_bits is 0
 * for a coefficient that is known to its last bit. */
static bool lacks_scans(const struct jpeg_decompress_struct *info)
{
	if (!info->progressive_mode || !info->coef_bits)
		return false;
	for (int c = 0; c < info->num_components; c++)
		for (int i = 0; i < DCTSIZE2; i++)
			if (info->coef_bits[c][i] != 0)
				return true;
	return false;
}

int jpeg_decoder_read(struct jpeg_decoder *jpeg, enum jpeg_pixels kind, uint8_t *pixels,
		      size_t stride, int width, int height, struct fault *fault)
{
	struct jpeg_decompress_struct *info = &jpeg->info;

	if (width < 1 || height < 1 || info->image_width < (JDIMENSION)width ||
	    info->image_height < (JDIMENSION)height)
		return fault_say(fault, -EBADMSG, "a JPEG picture of %ux%u, expected %dx%d",
				 info->image_width, info->image_height, width, height);
	if (!jpeg_grow_row(jpeg, (size_t)info->image_width * 4))
		return fault_say(fault, -ENOMEM, "no memory to decode a JPEG picture");
	if (setjmp(jpeg->failed))
		return jpeg_refuse(jpeg, "a damaged JPEG picture", fault);
	if (info->jpeg_color_space == JCS_CMYK || info->jpeg_color_space == JCS_YCCK)
		info->out_color_space = JCS_CMYK;
	else
		info->out_color_space = kind == JPEG_BGRX ? JCS_EXT_BGRA : JCS_EXT_RGB;
	info->dct_method = JDCT_ISLOW;
	jpeg_start_decompress(info);
	read_rows(jpeg, kind, pixels, stride, width, height);
	if (!jpeg->damage[0] && jpeg->cut && lacks_scans(info))
		snprintf(jpeg->damage, sizeof(jpeg->damage), "it ends before its last scan");
	return jpeg->damage[0] ? jpeg_refuse(jpeg, "a damaged JPEG picture", fault) : 0;
}
