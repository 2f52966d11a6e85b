/* SPDX-License-Identifier: MIT */
#include "tests/support/bake/baked_rows.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/optics/sky_square.h"

/* out[i] += what a block says of light i at its p-th pixel, channel c. The block has no
 * patterns. */
static void baked_add(const struct basis *basis, const struct basis_block *block, int p, int c,
		      double *out)
{
	const int channel = block->channels == 3 ? c : 0;
	const double tint = block->tint
				    ? block->tint[c * block->pixels + p] / (double)BASIS_TINT_ONE
				    : 1;

	assert_int_equal(block->patterns, 0);
	assert_int_equal(block->bits, 16);
	for (int n = 0; n < block->columns; n++) {
		const size_t panels = (size_t)basis_panels16(block->pixels);
		const size_t line = ((size_t)channel * panels + (size_t)(p / BASIS_LINE16)) *
					    (size_t)block->columns +
				    (size_t)n;
		const int i = block->light[n];

		out[i] += tint * (double)block->column_scale[n] *
			  block->column16[line * BASIS_LINE16 + (size_t)(p % BASIS_LINE16)] *
			  (block->kind == BASIS_KIND_V ? 1 : basis->lights[i].solid_angle_sr);
	}
}

bool baked_row(const struct basis *basis, int x, int y, enum basis_kind kind, int c, double *out)
{
	const int tile = y / BASIS_TILE * basis->tiles_across + x / BASIS_TILE;
	const struct basis_tile *t = &basis->poses[0].exact.tiles[tile];
	const int want = y % BASIS_TILE * BASIS_TILE + x % BASIS_TILE;
	bool found = false;

	memset(out, 0, basis->info.lights * sizeof(*out));
	for (int b = 0; b < t->block_count; b++) {
		const struct basis_block *block = &t->blocks[b];

		for (int p = 0; block->kind == kind && p < block->pixels; p++)
			if (block->pixel[p] == want) {
				baked_add(basis, block, p, c, out);
				found = true;
			}
	}
	return found;
}

double baked_object(const struct basis *basis, int x, int y, int c, const double *light)
{
	double row[BASIS_LIGHTS_MAX], sum = 0;

	baked_row(basis, x, y, BASIS_KIND_T, c, row);
	for (uint32_t i = 0; i < basis->info.lights; i++)
		sum += row[i] * (light ? light[i] : 1);
	return sum + baked_mirrored(basis, x, y, c, light);
}

double baked_mirrored(const struct basis *basis, int x, int y, int c, const double *light)
{
	const struct basis_pose *pose = &basis->poses[0];
	double sum = 0;

	for (size_t k = 0; k < pose->mirror_count; k++) {
		const struct basis_mirror *m = &pose->mirror[k];
		const double place[2] = {m->u / 65536.0, m->v / 65536.0};
		double d[3], near = -2, seen = 1;

		if (m->x != x || m->y != y)
			continue;
		sky_square_direction(place, d);
		for (uint32_t i = 0; light && i < basis->info.lights; i++) {
			const double *to = basis->lights[i].direction;
			const double dot = d[0] * to[0] + d[1] * to[1] + d[2] * to[2];

			seen = dot > near ? light[i] : seen;
			near = dot > near ? dot : near;
		}
		sum += m->throughput[c] / 65535.0 * seen;
	}
	return sum;
}

double baked_ratio(const struct basis *basis, int x, int y, int c, const double *light)
{
	static double change[BASIS_LIGHTS_MAX], own[BASIS_LIGHTS_MAX];
	const double *u = own;
	double taken = 0, all = 0;
	bool shared = false;

	if (!baked_row(basis, x, y, BASIS_KIND_D, c, change) ||
	    !baked_row(basis, x, y, BASIS_KIND_U, c, own)) {
		if (!baked_row(basis, x, y, BASIS_KIND_V, c, change))
			return 1;
		u = basis_ground(basis, 0, c);
		shared = true;
	}
	for (uint32_t i = 0; i < basis->info.lights; i++) {
		const double l = light ? light[i] : 1;

		taken += change[i] * l * (shared ? u[i] : 1);
		all += u[i] * l;
	}
	return all > 0 ? 1 - taken / all : 1;
}

double baked_through(const struct basis *basis, int x, int y, int c)
{
	const struct basis_pose *pose = &basis->poses[0];

	for (size_t k = 0; k < pose->glass_count; k++)
		if (pose->glass[k].x == x && pose->glass[k].y == y)
			return pose->glass[k].transmission[c] / 65535.0;
	return 0;
}

double baked_coverage(const struct basis *basis, int x, int y)
{
	return basis->poses[0].coverage[(size_t)y * basis->info.width + (size_t)x] / 65535.0;
}
