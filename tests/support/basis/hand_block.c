/* SPDX-License-Identifier: MIT */
#include "tests/support/basis/hand_block.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/optics/dome.h"
#include "tests/support/expect.h"

void hand_block_lights(int frequency, int lights, struct basis_light *light)
{
	struct fault fault = {""};
	struct dome dome;

	expect_success(dome_create(&dome, frequency, &fault), &fault);
	assert_int_equal(dome.count, lights);
	for (int i = 0; i < lights; i++) {
		memcpy(light[i].direction, dome.direction[i], sizeof(light[i].direction));
		light[i].solid_angle_sr = dome.solid_angle_sr[i];
	}
	dome_free(&dome);
}

struct basis_block_payload hand_block_of_object(uint32_t tile, int pixels, const uint16_t *pixel,
						int lights, const struct basis_light *light,
						const float *value)
{
	struct basis_block_entry entry = {.tile = tile,
					  .kind = BASIS_KIND_T,
					  .channels = 3,
					  .bits = 16,
					  .pixels = (uint16_t)pixels,
					  .columns = (uint32_t)lights,
					  .cut_share = 1};
	const struct basis_layout at = basis_layout(&entry, lights);
	uint8_t *payload = calloc(1, at.bytes);
	int16_t *column;
	float *scale;

	if (!payload)
		abort();
	entry.bytes = at.bytes;
	memcpy(payload + at.pixel, pixel, sizeof(*pixel) * (size_t)pixels);
	scale = (float *)(payload + at.column_scale);
	column = (int16_t *)(payload + at.column);
	for (int i = 0; i < lights; i++) {
		float most = 0;

		((uint16_t *)(payload + at.light))[i] = (uint16_t)i;
		for (int k = 0; k < pixels * 3; k++)
			most = fmaxf(most, fabsf(value[k * lights + i]));
		scale[i] = (float)((double)most / light[i].solid_angle_sr / 32767);
		for (int k = 0; k < pixels * 3 && most > 0; k++) {
			const int p = k / 3, c = k % 3;
			const int line = (c * at.panels16 + p / BASIS_LINE16) * lights + i;

			column[line * BASIS_LINE16 + p % BASIS_LINE16] =
				(int16_t)lrintf(value[k * lights + i] / most * 32767);
		}
	}
	return (struct basis_block_payload){entry, payload};
}

void hand_block_file(const char *path, const struct basis_info_chunk *info,
		     const struct basis_light *light, const struct basis_block_payload *block,
		     const uint16_t *coverage, const float (*peak)[3])
{
	struct fault fault = {""};
	struct basis_writer *writer;

	expect_success(basis_writer_open(&writer, path, info, light, NULL, NULL, "", &fault),
		       &fault);
	expect_success(basis_writer_blocks(writer, block, 1, &fault), &fault);
	expect_success(basis_writer_pose_end(writer, coverage, peak, &fault), &fault);
	expect_success(basis_writer_finish(writer, info, "", &fault), &fault);
	free((void *)block->payload);
}
