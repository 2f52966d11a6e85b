/*
 * The basis file (.inlay), as it lies on disk: little-endian, version 1.
 *
 *     struct basis_file_header
 *     struct basis_chunk_entry [chunk_count]     in the order of their offsets
 *     chunks, each starting on a page (4096); zeros between them
 *
 * What is stored, for pixel p, light i, channel c (all of it linear light):
 *
 *   T  t[p,i,c]  object radiance towards the camera per unit radiance of cell i, averaged over the
 *                whole pixel (samples that miss the object count as 0): premultiplied by coverage.
 *   V  v[p,i,c] = (u - s) / u: the share of cell i's light on this receiver that the object takes
 *                away (negative: adds), averaged over the pixel's receiver samples, on a receiver
 *                whose u is one of the file's shared ground terms. 0 is unchanged, 1 is a full
 *                shadow.
 *   D  d[p,i,c] = u - s, and
 *   U  u[p,i,c]  the same for receivers that have a u of their own (stand-in meshes).
 *
 * A pixel that its tile does not list, and whose coverage is 0, is not changed by the object. One
 * that is covered but has no T row holds an object that gives off no light.
 *
 * Storing v, not d: then ratio = 1 - sum v_i u_i L_i / sum u_i L_i is a weighted mean of the v_i,
 * so an error of e in every v_i is an error of at most e in the ratio, whatever the light.
 *
 * The lights that a V block does not list may share one value for each row, the rest: light that
 * the object throws on the ground changes v of all lights by about as much, while its shadow is
 * sharp in a few.
 *
 * A reader accepts a file only if all of this holds: README.md lists every rule.
 */
#ifndef INLAY_HAL_BASIS_BASIS_FORMAT_H
#define INLAY_HAL_BASIS_BASIS_FORMAT_H

#include <stdint.h>

#define BASIS_MAGIC "INLAYBAS"
#define BASIS_VERSION 1
#define BASIS_PAGE 4096
#define BASIS_ALIGN 64 /* of every array inside a block */

#define BASIS_LIGHTS_MAX 32768
#define BASIS_SIDE_MAX 16384
/* Pixels a side of a tile. Tiles go row by row; the right and lower edge cut them. */
#define BASIS_TILE 16
#define BASIS_GROUNDS_MAX 256
#define BASIS_GROUND_MAX 1e30 /* of u: so that no sum of u L overflows */
#define BASIS_CHUNKS_MAX 65536

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

#define BASIS_FOURCC(a, b, c, d)                                                                   \
	((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

enum basis_chunk {
	BASIS_CHUNK_INFO = BASIS_FOURCC('I', 'N', 'F', 'O'),   /* struct basis_info_chunk */
	BASIS_CHUNK_DOME = BASIS_FOURCC('D', 'O', 'M', 'E'),   /* struct basis_light[lights] */
	BASIS_CHUNK_GROUND = BASIS_FOURCC('G', 'R', 'N', 'D'), /* double [grounds][3][lights]: u */
	/* uint16 [height][width], 65535 = 1 */
	BASIS_CHUNK_COVERAGE = BASIS_FOURCC('C', 'O', 'V', 'R'),
	BASIS_CHUNK_BLOCKS = BASIS_FOURCC('B', 'L', 'C',
					  'K'), /* struct basis_block_entry[] by tile */
	BASIS_CHUNK_DATA = BASIS_FOURCC('D', 'A', 'T', 'A'), /* the blocks' payloads */
	/* float [lights + 1][3]: the largest t[p,i,c] of any pixel; the last row holds the largest
	 * sum over i of t[p,i,c] */
	BASIS_CHUNK_PEAK = BASIS_FOURCC('P', 'E', 'A', 'K'),
	/* Texts end in a NUL byte, their only one. */
	BASIS_CHUNK_CAMERA = BASIS_FOURCC('C', 'A', 'M', 'R'),	   /* the camera as INI */
	BASIS_CHUNK_PROVENANCE = BASIS_FOURCC('P', 'R', 'O', 'V'), /* key = value lines */
};

struct basis_info_chunk {
	uint32_t width, height;
	uint32_t lights;
	uint32_t dome_frequency, dome_division;
	uint32_t grounds;
	uint32_t poses; /* >= 1 */
	uint32_t reserved;
	/*
	 * Declared errors. The first two are bounds for any lighting, quantisation and cuts
	 * together; the error of the light cells themselves is not in them.
	 *   object_error  |error of sum t L| <= this * sum over i of L_i
	 *   ratio_error   |error of the ratio| <= this (V blocks)
	 *   noise_levels  estimated standard error of the render, 8-bit sRGB levels, RMS over
	 *                 stored pixels under a uniform sky of radiance 1; 0: not known
	 */
	double object_error;
	double ratio_error;
	double noise_levels;
};

struct basis_light {
	double direction[3];
	double solid_angle_sr;
};

enum basis_kind { BASIS_KIND_T, BASIS_KIND_V, BASIS_KIND_D, BASIS_KIND_U, BASIS_KIND_COUNT };

enum basis_encoding {
	/*
	 * Rows of 15 bits and sign over a list of lights:
	 *     uint16 pixel[pixels]             y * BASIS_TILE + x, ascending
	 *     uint16 light[lights]             ascending; in V blocks the last may be N, the
	 *                                      number of lights: the rest, a value that all lights
	 *                                      not listed share. Without it they are 0.
	 *     float  scale[pixels][channels]   value = scale * row; >= 0
	 *     int32  total[pixels][channels]   T, D, U: sum of the row
	 *            total[pixels][3]          V: round(2^15 * sum row_i u_i / sum over all lights
	 *                                      of u_i), 0 where no u_i is; u of the rest is the
	 *                                      sum over the lights not listed; 3 because u may
	 *                                      differ by channel where v does not
	 *     int16  row[pixels][channels][stride]   stride = lights rounded up to 32; -32768 does
	 *                                      not occur, and rows of U are not negative
	 * each array starting at a multiple of BASIS_ALIGN, padding 0 (basis_layout.h). channels is
	 * 3, or 1 where all three channels share a row.
	 */
	BASIS_ENCODING_DENSE = 1,
};

/* In the order of tiles; offsets ascend too. A D block is followed by the U block of its pixels. */
struct basis_block_entry {
	uint32_t tile;
	uint16_t kind, encoding;
	uint16_t pixels;   /* 1..BASIS_TILE^2 */
	uint16_t channels; /* 1 or 3 */
	uint32_t lights;   /* 1..N: how long the list is, the rest included */
	uint64_t offset;   /* in the DATA chunk, a multiple of BASIS_ALIGN */
	uint64_t bytes;
	uint32_t ground; /* of a V block: index of its shared ground term; else 0 */
	uint32_t reserved;
};

#endif
