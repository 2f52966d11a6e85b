/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

enum { START_CODE = 3 };
enum { SLICE = 1, SLICE_IDR = 5, SEQUENCE_SET = 7, PICTURE_SET = 8 }; /* nal_unit_type */

/* The payload of a NAL unit, bit by bit; after its end come zeros. */
struct bits {
	const uint8_t *data;
	size_t bytes, at;
	unsigned left; /* bits of data[at] that are not read yet */
};

static struct bits bits_of(const uint8_t *data, size_t bytes)
{
	return (struct bits){data, bytes, 0, 8};
}

/* A 3 after two zeros is no payload: it prevents the emulation of a start code. */
static void bits_next_byte(struct bits *b)
{
	b->at++;
	b->left = 8;
	if (b->at >= 2 && b->at < b->bytes && b->data[b->at] == 3 && b->data[b->at - 1] == 0 &&
	    b->data[b->at - 2] == 0)
		b->at++;
}

static unsigned bits_take(struct bits *b, int count)
{
	unsigned value = 0;

	while (count-- > 0) {
		const unsigned byte = b->at < b->bytes ? b->data[b->at] : 0;

		value = value << 1 | (byte >> --b->left & 1);
		if (b->left == 0)
			bits_next_byte(b);
	}
	return value;
}

/* ue(v), H.264 9.1; of a code that is too long, 0. */
static unsigned bits_take_golomb(struct bits *b)
{
	int zeros = 0;

	while (zeros < 32 && bits_take(b, 1) == 0)
		zeros++;
	return zeros < 32 ? (1U << zeros) - 1 + bits_take(b, zeros) : 0;
}

static int bits_take_signed(struct bits *b)
{
	const unsigned code = bits_take_golomb(b);

	return code & 1 ? (int)(code / 2 + 1) : -(int)(code / 2);
}

static void skip_scaling_list(struct bits *b, int size)
{
	int last = 8, next = 8;

	for (int i = 0; i < size && next != 0; i++) {
		next = (last + bits_take_signed(b) + 256) & 255;
		last = next ? next : last;
	}
}

static bool has_chroma_format(unsigned profile)
{
	static const uint8_t profiles[] = {100, 110, 122, 244, 44,  83, 86,
					   118, 128, 138, 139, 134, 135};

	for (size_t i = 0; i < sizeof(profiles); i++)
		if (profiles[i] == profile)
			return true;
	return false;
}

static void skip_chroma_format(struct bits *b)
{
	const unsigned chroma = bits_take_golomb(b);

	if (chroma == 3)
		bits_take(b, 1); /* separate_colour_plane_flag */
	bits_take_golomb(b);	 /* bit_depth_luma_minus8 */
	bits_take_golomb(b);	 /* bit_depth_chroma_minus8 */
	bits_take(b, 1);	 /* qpprime_y_zero_transform_bypass_flag */
	if (!bits_take(b, 1))	 /* seq_scaling_matrix_present_flag */
		return;
	for (int i = 0; i < (chroma == 3 ? 12 : 8); i++)
		if (bits_take(b, 1))
			skip_scaling_list(b, i < 6 ? 16 : 64);
}

static void read_sequence_set(struct h264_count *count, struct bits b)
{
	const unsigned profile = bits_take(&b, 8);
	unsigned more;

	bits_take(&b, 16);    /* constraint flags, level_idc */
	bits_take_golomb(&b); /* seq_parameter_set_id */
	if (has_chroma_format(profile))
		skip_chroma_format(&b);
	more = bits_take_golomb(&b); /* log2_max_frame_num_minus4 */
	count->bits = more <= 12 ? more + 4 : 0;
}

/* A picture has the number of the last reference picture, or the next one. */
static bool read_slice(struct h264_count *count, unsigned header, struct bits b)
{
	const unsigned wrap = 1U << count->bits;
	bool gap = false;
	unsigned number;

	if (count->bits == 0)
		return false;
	bits_take_golomb(&b); /* first_mb_in_slice */
	bits_take_golomb(&b); /* slice_type */
	bits_take_golomb(&b); /* pic_parameter_set_id */
	number = bits_take(&b, (int)count->bits);
	if ((header & 31) != SLICE_IDR && count->begun)
		gap = (number - count->reference) % wrap > 1;
	if (header >> 5 & 3) /* nal_ref_idc */
		*count = (struct h264_count){count->bits, true, number};
	return gap;
}

/* Offset behind the next start code; bytes if there is none. */
static size_t find_unit(const uint8_t *data, size_t from, size_t bytes)
{
	for (size_t i = from; i + START_CODE < bytes; i++)
		if (data[i] == 0 && data[i + 1] == 0 && data[i + 2] == 1)
			return i + START_CODE;
	return bytes;
}

struct h264_unit h264_unit_read(struct h264_count *count, const uint8_t *data, size_t bytes)
{
	struct h264_unit unit = {0};
	size_t next = find_unit(data, 0, bytes);

	while (next < bytes && !unit.picture) {
		const size_t at = next;
		const unsigned type = data[at] & 31;
		const struct bits b = bits_of(data + at + 1, bytes - at - 1);

		next = find_unit(data, at, bytes);
		if (type == SEQUENCE_SET)
			read_sequence_set(count, b);
		if (type == SEQUENCE_SET || type == PICTURE_SET) {
			if (unit.sets_bytes == 0) {
				unit.sets_at = at - START_CODE;
				unit.sequence = type == SEQUENCE_SET;
			}
			unit.sets_bytes = (next < bytes ? next - START_CODE : bytes) - unit.sets_at;
		}
		if (type == SLICE_IDR || type == SLICE) {
			unit.picture = true;
			unit.gap = read_slice(count, data[at], b);
		}
	}
	return unit;
}
