/* SPDX-License-Identifier: MIT */
/* NEON of aarch64: eight pixels at a time; the C functions of frame_ycbcr.h convert the rest. */
#include <arm_neon.h>

#include "hal/base/processor.h"
#include "hal/frame/frame_rows.h"

enum { PIXELS = 8 };

/* Blue, green and red of four pixels. */
struct quad {
	int32x4_t b, g, r;
};

static inline float32x4_t neon_luma(const struct ycbcr *k, uint16x4_t y)
{
	return vaddq_f32(vmulq_n_f32(vcvtq_f32_u32(vmovl_u16(y)), k->y_scale),
			 vdupq_n_f32(k->y_offset));
}

/* chroma: Cb and Cr of a pair in its two lanes. */
static inline struct quad neon_convert4(const struct ycbcr *k, uint16x4_t y, uint16x4_t chroma)
{
	const float32x4_t luma = neon_luma(k, y);
	const float32x4_t c = vsubq_f32(vcvtq_f32_u32(vmovl_u16(chroma)), vdupq_n_f32(128));
	const float32x4_t u = vtrn1q_f32(c, c), v = vtrn2q_f32(c, c);
	const float32x4_t g = vaddq_f32(vmulq_n_f32(u, k->g_cb), vmulq_n_f32(v, k->g_cr));

	return (struct quad){
		vcvtq_s32_f32(vaddq_f32(luma, vmulq_n_f32(u, k->b_cb))),
		vcvtq_s32_f32(vaddq_f32(luma, g)),
		vcvtq_s32_f32(vaddq_f32(luma, vmulq_n_f32(v, k->r_cr))),
	};
}

/* Narrowing saturates to 0..255, and truncation has made values in (-1, 0) zero: the same result as
 * clamping before truncation. */
static inline uint8x8_t neon_narrow(int32x4_t low, int32x4_t high)
{
	return vqmovn_u16(vcombine_u16(vqmovun_s32(low), vqmovun_s32(high)));
}

static inline void neon_convert8(const struct ycbcr *k, uint8x8_t y, uint8x8_t chroma,
				 uint32_t *bgrx)
{
	const uint16x8_t wide_y = vmovl_u8(y), wide_chroma = vmovl_u8(chroma);
	const struct quad low = neon_convert4(k, vget_low_u16(wide_y), vget_low_u16(wide_chroma));
	const struct quad high = neon_convert4(k, vget_high_u16(wide_y),
					       vget_high_u16(wide_chroma));
	const uint8x8x4_t pixels = {{
		neon_narrow(low.b, high.b),
		neon_narrow(low.g, high.g),
		neon_narrow(low.r, high.r),
		vdup_n_u8(255),
	}};

	vst4_u8((uint8_t *)bgrx, pixels);
}

static void neon_yuyv(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	const struct ycbcr m = *k;

	for (; count >= PIXELS; count -= PIXELS, from += 2 * PIXELS, bgrx += PIXELS) {
		const uint8x8x2_t parts = vld2_u8(from);

		neon_convert8(&m, parts.val[0], parts.val[1], bgrx);
	}
	ycbcr_row_yuyv(k, from, count, bgrx);
}

static void neon_uyvy(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	const struct ycbcr m = *k;

	for (; count >= PIXELS; count -= PIXELS, from += 2 * PIXELS, bgrx += PIXELS) {
		const uint8x8x2_t parts = vld2_u8(from);

		neon_convert8(&m, parts.val[1], parts.val[0], bgrx);
	}
	ycbcr_row_uyvy(k, from, count, bgrx);
}

static void neon_nv12(const struct ycbcr *k, const uint8_t *y, const uint8_t *cbcr, int count,
		      uint32_t *bgrx)
{
	const struct ycbcr m = *k;

	for (; count >= PIXELS; count -= PIXELS, y += PIXELS, cbcr += PIXELS, bgrx += PIXELS)
		neon_convert8(&m, vld1_u8(y), vld1_u8(cbcr), bgrx);
	ycbcr_row_nv12(k, y, cbcr, count, bgrx);
}

static void neon_grey(const struct ycbcr *k, const uint8_t *y, int count, uint32_t *bgrx)
{
	const struct ycbcr m = *k;

	for (; count >= PIXELS; count -= PIXELS, y += PIXELS, bgrx += PIXELS) {
		const uint16x8_t wide = vmovl_u8(vld1_u8(y));
		const uint8x8_t code =
			neon_narrow(vcvtq_s32_f32(neon_luma(&m, vget_low_u16(wide))),
				    vcvtq_s32_f32(neon_luma(&m, vget_high_u16(wide))));
		const uint8x8x4_t pixels = {{code, code, code, vdup_n_u8(255)}};

		vst4_u8((uint8_t *)bgrx, pixels);
	}
	ycbcr_row_grey(k, y, count, bgrx);
}

static inline uint32x4_t back_to_front(uint32x4_t pixels)
{
	const uint32x4_t halves = vrev64q_u32(pixels);

	return vextq_u32(halves, halves, 2);
}

/* Swaps vectors from both ends towards the middle. */
static void neon_reverse(uint32_t *bgrx, int count)
{
	uint32_t *end = bgrx + count;

	for (; count >= PIXELS; count -= PIXELS, bgrx += PIXELS / 2) {
		const uint32x4_t left = vld1q_u32(bgrx);
		const uint32x4_t right = vld1q_u32(end - PIXELS / 2);

		end -= PIXELS / 2;
		vst1q_u32(end, back_to_front(left));
		vst1q_u32(bgrx, back_to_front(right));
	}
	bgrx_row_reverse(bgrx, count);
}

const struct frame_rows frame_rows_neon = {
	.name = "neon",
	.needs = PROCESSOR_NEON,
	.yuyv = neon_yuyv,
	.uyvy = neon_uyvy,
	.nv12 = neon_nv12,
	.grey = neon_grey,
	.reverse = neon_reverse,
};
