/* SPDX-License-Identifier: MIT */
/*
 * The basis file (.inlay), as it lies on disk: little-endian, version 9.
 *
 *     struct basis_file_header
 *     struct basis_chunk_entry [chunk_count]     in the order of their offsets
 *     chunks, each starting on a page (4096); zeros between them
 *
 * What is stored, for pixel p, light i, channel c (all of it linear light):
 *
 *   T  object radiance towards the camera, averaged over the whole pixel (samples that miss the
 *      object count as 0): premultiplied by coverage.
 *   V  v = (u - s) / u: the share of cell i's light on this receiver that the object takes away
 *      (negative: adds), averaged over the pixel's receiver samples, on a receiver whose u is one
 *      of the file's shared ground terms. 0 is unchanged, 1 is a full shadow.
 *   D  d = u - s, and
 *   U  u, for receivers that have a u of their own (stand-in meshes).
 *
 * Each is per unit of X_i, the light that cell i sends:
 *
 *   T, D, U   X_i = w_i L_i       w_i: solid angle of the cell; so t, d and u are divided by w_i
 *   V         X_i = u_i L_i       u_i: the ground's term, which depends on the channel
 *
 * so that a column changes smoothly with the direction of its light, and an error of e in every
 * column is at most e sum X_i in T, and at most e in the ratio.
 *
 * A block holds the columns of some pixels of a tile as a sum of two parts, either of which may be
 * empty:
 *
 *     value[p,c] = tint[p,c] * (pattern part + column part)
 *     pattern part = sum_j pattern_scale_j * coefficient[p,c,j] * y_j,c
 *     column part  = sum_n column_scale_n * column[p,c,n] * X_n,c
 *     y_j,c = sum_k pattern[j,k] * Y_k,c
 *     Y_k,c = sum_i P_ki * X_i,c
 *
 * Y are the coarse lights: the light of all N cells gathered in K <= N places by COAR, a sparse
 * matrix that the whole file shares; so what a tile costs does not depend on N. A pattern is a mix
 * of the coarse lights. A column is of one light by itself: all that this light does where there
 * are no patterns, else what the patterns leave wrong about it.
 *
 * Neighbouring lights mostly send alike, and their columns are then read for what they have in
 * common. So a column may also be a group's, of number N + k: group k are the lights that give more
 * to coarse light k than to any other (the first of equals), and its column is the sum over the
 * columns of these lights, each times q_i,
 *
 *     q_i = w_i / sum of w over the group       w of T: the solid angle; of V: u_i, summed over the
 *                                               channels
 *
 * to within half of its own scale. These are the columns of its block, and of those that follow it
 * or that it follows, one behind the other in their tile, with the same kind, ground, channels and
 * pixels: a group's column may have 8 bits where lights of it need 16, as its own light is never
 * far above what may be left out. With any S_k,c the sum over the columns of the group is
 *
 *     scale * column * S_k,c + sum over the group's of scale_n * column_n * (X_n,c - q_n S_k,c)
 *
 * where S = 0 is the sum above, and another S (basis_groups.h) leaves little to the single lights.
 * Groups are there so that more columns may be left out: a file whose column_cut is 0 has none.
 *
 * Blocks add up: the shadow (one channel) and the light that the object throws (three) may be two V
 * blocks over the same pixels.
 *
 * A pixel that its tile does not list, and whose coverage is 0, is not changed by the object. One
 * that is covered but has no T row holds an object that gives off no light.
 *
 * The same pose may be there twice: BLCK and DATA hold what is shown, within the declared errors;
 * BLCX and DATX, which may be absent, hold every light's column in 16 bits and no patterns: what
 * the other is held against.
 *
 * A reader accepts a file only if all of this holds: README.md lists every rule.
 */
#ifndef INLAY_HAL_BASIS_BASIS_FORMAT_H
#define INLAY_HAL_BASIS_BASIS_FORMAT_H

#include <stdint.h>

#define BASIS_MAGIC "INLAYBAS"
#define BASIS_VERSION 9
#define BASIS_PAGE 4096
#define BASIS_ALIGN 64 /* of every array inside a block */

#define BASIS_LIGHTS_MAX 32768
#define BASIS_SIDE_MAX 16384
/* Pixels a side of a tile. Tiles go row by row; the right and lower edge cut them. */
#define BASIS_TILE 16
#define BASIS_GROUNDS_MAX 256
#define BASIS_GROUND_MAX 1e30 /* of u: so that no sum of u L overflows */
#define BASIS_CHUNKS_MAX 65536
#define BASIS_POSES_MAX 8192
#define BASIS_POSE_NAME_MAX 32	/* with its NUL */
#define BASIS_PATTERNS_MAX 1024 /* of a block */
/* No value per unit of X exceeds this before its tint. Held are, for columns of 16 bits,
 * scale * 32767; for those of 8, scale * 127; for each pattern,
 * scale * 32767 * sum over k of |pattern[j,k]|. */
#define BASIS_VALUE_MAX 65536.0
#define BASIS_TINT_ONE 32768
/* Of a light's three places among the coarse lights; their weights sum to this. */
#define BASIS_COARSE_ONE 32768

struct basis_file_header {
	char magic[8];
	uint32_t version;
	uint32_t chunk_count;
	uint64_t file_bytes;
	uint64_t checksum; /* XXH3-64 of header (this field 0) and chunk table */
};

struct basis_chunk_entry {
	uint32_t type; /* enum basis_chunk */
	uint32_t pose; /* 0 for what all poses share */
	uint64_t offset;
	uint64_t bytes;
	uint64_t checksum; /* XXH3-64 of the chunk */
};

/*
 * What one light of the dome is. Its solid angle w_i is the integral of its weight over the sky.
 *   cell   weight 1 in the directions nearest to its node, 0 elsewhere
 *   tent   weight 1 at its node, falling linearly to 0 across the dome's triangles around it: the
 *          weights of a direction add up to 1, and a lamp that moves is handed from light to light
 */
enum basis_light_shape { BASIS_LIGHT_CELL, BASIS_LIGHT_TENT, BASIS_LIGHT_SHAPE_COUNT };

#define BASIS_FOURCC(a, b, c, d)                                                                   \
	((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

enum basis_chunk {
	BASIS_CHUNK_INFO = BASIS_FOURCC('I', 'N', 'F', 'O'),   /* struct basis_info_chunk */
	BASIS_CHUNK_DOME = BASIS_FOURCC('D', 'O', 'M', 'E'),   /* struct basis_light[lights] */
	BASIS_CHUNK_GROUND = BASIS_FOURCC('G', 'R', 'N', 'D'), /* double [grounds][3][lights]: u */
	/* uint16 [height][width], 65535 = 1 */
	BASIS_CHUNK_COVERAGE = BASIS_FOURCC('C', 'O', 'V', 'R'),
	/* struct basis_coarse [lights]; absent when each light is its own (coarse == lights) */
	BASIS_CHUNK_COARSE = BASIS_FOURCC('C', 'O', 'A', 'R'),
	/* struct basis_block_entry[], and the blocks' payloads */
	BASIS_CHUNK_BLOCKS = BASIS_FOURCC('B', 'L', 'C', 'K'),
	BASIS_CHUNK_DATA = BASIS_FOURCC('D', 'A', 'T', 'A'),
	BASIS_CHUNK_EXACT_BLOCKS = BASIS_FOURCC('B', 'L', 'C', 'X'),
	BASIS_CHUNK_EXACT_DATA = BASIS_FOURCC('D', 'A', 'T', 'X'),
	/* float [lights + 1][3]: the largest radiance that any pixel of the object gives off per
	 * unit of L_i; the last row holds the largest under L_i = 1 for all i */
	BASIS_CHUNK_PEAK = BASIS_FOURCC('P', 'E', 'A', 'K'),
	/* in the place of a pose's COVR and DATA: struct basis_pack, struct basis_pack_part
	 * [parts], coverage, and the parts' streams */
	BASIS_CHUNK_PACK = BASIS_FOURCC('P', 'A', 'C', 'K'),
	/* struct basis_glass []: where the background is seen through the object; may be absent */
	BASIS_CHUNK_GLASS = BASIS_FOURCC('G', 'L', 'A', 'S'),
	/* struct basis_pose_name [poses]; may be absent */
	BASIS_CHUNK_POSES = BASIS_FOURCC('P', 'O', 'S', 'E'),
	/* Texts end in a NUL byte, their only one. */
	BASIS_CHUNK_CAMERA = BASIS_FOURCC('C', 'A', 'M', 'R'),	   /* the camera as INI */
	BASIS_CHUNK_PROVENANCE = BASIS_FOURCC('P', 'R', 'O', 'V'), /* key = value lines */
};

struct basis_info_chunk {
	uint32_t width, height;
	uint32_t lights;
	uint32_t dome_frequency, dome_division;
	uint32_t grounds;
	uint32_t poses;	      /* >= 1 */
	uint32_t coarse;      /* K, 1..lights */
	uint32_t light_shape; /* enum basis_light_shape */
	uint32_t reserved;    /* 0 */
	/*
	 * Declared errors; that of the light cells themselves is in none of them.
	 *
	 * column_cut: a column that changes no pixel by more than this, as linear light (T, white
	 * is 1) or in the ratio (V), may be left out of a frame; a group's, if by no more than
	 * basis_group_cut(). The measured errors count that in.
	 *
	 * Bounds for any lighting, quantisation and cuts together, if every column is used:
	 *   object_error  |error of O| <= this * sum over i of X_i
	 *   ratio_error   |error of the ratio| <= this (V blocks)
	 * Measured by the bake against its own transport before any cut, in 8-bit sRGB levels over
	 * stored pixels, the background being the ground's own light, or white under a cell
	 * alone (bake/encode/ensemble.h):
	 *   sky_rms, sky_max    the worst of an ensemble of lightings: overcast, suns, random
	 *   cell_rms, cell_max  every cell lit alone (RMS over all of them)
	 * noise_levels  estimated standard error of the render, 8-bit sRGB levels, RMS over stored
	 *               pixels under a uniform sky of radiance 1; 0: not known
	 */
	double column_cut;
	double object_error;
	double ratio_error;
	double sky_rms, sky_max;
	double cell_rms, cell_max;
	double noise_levels;
};

struct basis_light {
	double direction[3];
	double solid_angle_sr;
};

/* P_ki of one light, times BASIS_COARSE_ONE: three coarse lights, ascending where the weight is not
 * 0; unused ones have index 0 and weight 0 and come last. */
struct basis_coarse {
	uint16_t index[3];
	uint16_t weight[3];
};

/* What a pose is called: letters, digits, - and _, not digits alone, no two alike; zeros behind it.
 * Empty: it has no name. */
struct basis_pose_name {
	char text[BASIS_POSE_NAME_MAX];
};

/*
 * A pixel in which the background B is seen through the object, straight or bent:
 *
 *     out = O + ratio * ((1 - coverage) * B(x, y) + transmission * B(x + dx, y + dy))
 *
 * transmission is what arrives of the background's light, averaged over the whole pixel like T:
 * samples that see none of it through the object count as 0, so it is at most coverage, as glass
 * covers. B(x + dx, y + dy) is the mean, in linear light, of what the picture shows in a rectangle
 * around the middle of the pixel moved by the offset; the picture's edge goes on beyond it. Its
 * sides are 1 + spread / BASIS_GLASS_SPREAD pixels, so straight glass shows the pixel itself. ratio
 * is that of the pixel's V, or D and U: they hold the mean over the real surfaces that are seen
 * beside the object (each sample counts 1) and through it (each counts the mean of its three
 * transmissions), and samples of the background without a real surface count as unchanged.
 */
#define BASIS_GLASS_STEP 16 /* of an offset, in a pixel */
#define BASIS_GLASS_SPREAD 4

/* In the order of tiles, in each by y, then x; no pixel twice. */
struct basis_glass {
	uint16_t x, y;		  /* in the picture */
	uint16_t transmission[3]; /* 65535 = 1 */
	int16_t dx, dy;
	uint8_t spread[2]; /* across, down */
};

enum basis_kind { BASIS_KIND_T, BASIS_KIND_V, BASIS_KIND_D, BASIS_KIND_U, BASIS_KIND_COUNT };

/*
 * A block's payload, each array starting at a multiple of BASIS_ALIGN, padding 0 (basis_layout.h):
 *
 *     uint16 pixel[pixels]               y * BASIS_TILE + x, ascending
 *     uint16 tint[3][pixels]             only when tinted; BASIS_TINT_ONE is 1
 *     float  pattern_scale[patterns]     finite, >= 0
 *     int16  pattern[patterns][stride]   stride = K rounded up to 32
 *     int16  coefficient[channels][panels16][patterns][32]
 *     uint16 light[columns]              ascending, < N; of groups N + k, k < K
 *     float  column_scale[columns]       finite, >= 0
 *     int16  column[channels][panels16][columns][32]      bits = 16
 *     uint32 record_at[columns]                           bits = 8: in bytes, from the first record
 *     uint8  record[record_bytes]                         bits = 8: basis_lines.h
 *
 * A panel is as many pixels of the block, in the order of its list, as fill a cache line:
 * panels16 = ceil(pixels / 32), panels8 = ceil(pixels / 64); places after the last pixel hold 0. A
 * line, 64 bytes, is one pattern or column for one panel and channel: what is read, or left out, as
 * a whole. Of columns of 16 bits most are read, panel by panel, all channels at once: three streams
 * from one end to the other, which a processor fetches ahead of. Of those of 8 bits a few are, here
 * and there, so that what is read of one lies together: its record, in which each line is as short
 * as it may be. Records follow each other in the order of columns without a gap. -32768, -128 and,
 * in half a byte, 15 do not occur.
 *
 * Every pixel of a D block is in one of its tile's U blocks; of U no light
 * alone comes out negative by more than quantisation.
 */
/* In the order of tiles, then of kinds; offsets ascend too. */
struct basis_block_entry {
	uint32_t tile;
	uint8_t kind;
	uint8_t channels; /* 3, or 1 where all three share their rows */
	uint8_t bits;	  /* 8 or 16: of columns; 16 where there are none */
	uint8_t tinted;	  /* 1: has a tint; only where channels is 1 */
	uint16_t pixels;  /* 1..BASIS_TILE^2 */
	uint16_t patterns;
	uint32_t columns;      /* 0..N + K; patterns + columns >= 1 */
	uint32_t ground;       /* of a V block: index of its shared ground term; else 0 */
	uint32_t record_bytes; /* of all records; 0 where bits is 16 */
	uint64_t offset;       /* in the DATA or DATX chunk, a multiple of BASIS_ALIGN */
	uint64_t bytes;
};

/*
 * A file of several poses shows one at a time, so the others may lie packed. PACK holds what COVR
 * and DATA would; payloads lie there one behind the other, without a gap, in parts of some blocks
 * each. A part is four streams, each one zstd frame (RFC 8878), or nothing where it is empty:
 *
 *     0  pixel, tint, pattern_scale, light and column_scale with their padding, as they are
 *     1  upper bytes of all 16-bit values: patterns, coefficients, columns
 *     2  their lower bytes
 *     3  records of columns of 8 bits, which tell what record_at is
 *
 * A value v is there as 2v, or -2v - 1 where it is negative, modulo 2^8 or 2^16. Coefficients and
 * columns are differences first: those of 16 bits from the value before, 0 before a block's first;
 * those of whole lines of 8 bits from the value before in the same row of BASIS_TILE places, a
 * row's first from that of the row before, each line by itself. Codes and short lines are as they
 * are.
 */
#define BASIS_PACK_STREAMS 4

struct basis_pack {
	uint64_t data_bytes; /* of DATA */
	uint32_t parts;
	uint32_t coverage_bytes; /* packed: one zstd frame of what COVR would be */
};

struct basis_pack_part {
	uint32_t blocks;		    /* the next so many of the list; >= 1 */
	uint32_t bytes[BASIS_PACK_STREAMS]; /* packed */
	uint32_t reserved;		    /* 0 */
};

#endif
