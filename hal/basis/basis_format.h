/* SPDX-License-Identifier: MIT */
/*
 * The basis file (.inlay), as it lies on disk: little-endian, version 10.
 *
 *     struct basis_file_header
 *     struct basis_chunk_entry [chunk_count]     in the order of their offsets
 *     chunks, each starting on a page (4096); zeros between them
 *
 * A file holds the light transfer from N lights to the pixels of a picture, in linear light.
 * hal/GLOSSARY.md lists all symbols. For light i, u is the radiance of a receiver (a real surface)
 * without the object, s the same with the object. For each pixel p, light i and channel c:
 *
 *   T  t: radiance of the object towards the camera, averaged over the whole pixel. Samples that
 *      miss the object count as 0, so t is premultiplied by coverage. Ground whose polish mirrors
 *      the object counts as the object.
 *   V  v = (u - s) / u: the share of light i that the object takes away from the receiver
 *      (negative: adds), averaged over the pixel's receiver samples. For receivers whose u is one
 *      of the file's shared ground terms. 0 is unchanged, 1 is a full shadow.
 *   D  d = u - s, and
 *   U  u, both for receivers that have a u of their own (stand-in meshes).
 *
 * Values are stored per unit of X_i, the light that cell i sends:
 *
 *   T, D, U   X_i = w_i L_i       w_i: solid angle of the cell; so t, d and u are divided by w_i
 *   V         X_i = u_i L_i       u_i: the ground's term, which depends on the channel
 *
 * so a column changes smoothly with the direction of its light, and an error of at most E in every
 * column makes an error of at most E sum X_i in T, and of at most E in the ratio (V).
 *
 * A block is the transfer matrix of some pixels of a tile: a low-rank part (patterns) plus sparse
 * residual columns. Either part may be empty:
 *
 *     value[p,c] = tint[p,c] * (pattern part + column part)
 *     pattern part = sum_j pattern_scale_j * coefficient[p,c,j] * y_j,c
 *     column part  = sum_n column_scale_n * column[p,c,n] * X_n,c
 *     y_j,c = sum_k pattern[j,k] * Y_k,c
 *     Y_k,c = sum_i P_ki * X_i,c
 *
 * Y_k are the coarse lights: P (chunk COAR), a sparse matrix that the whole file shares, gathers
 * the N lights in K <= N of them. Patterns are vectors over the coarse lights, so the cost of a
 * tile does not depend on N. The column of a light is its residual: its exact transfer less what
 * the patterns give.
 *
 * Neighbouring lights often send nearly the same light. Group k is the set of lights whose largest
 * weight in P is that of coarse light k (the first of equals). A column of number N + k belongs to
 * group k. It is the sum, to within half of its own scale,
 *
 *     column of group k = sum over the group of q_i * column of light i
 *     q_i = w_i / sum of w over the group
 *
 * where w is the solid angle (T), or u_i summed over the channels (V). The sum covers the columns
 * of consecutive blocks of a tile, its own among them, that have the same kind, ground, channels
 * and pixels: a group may have 8 bits where its lights have 16, because S is never far above the
 * cut. For any S_k,c the sum over the columns of the group is
 *
 *     scale * column * S_k,c + sum over the group of scale_n * column_n * (X_n,c - q_n S_k,c)
 *
 * S = 0 gives the formula above. A frame chooses S (basis_groups.h) so that X - q S is small and
 * more columns fall below the cut. A file whose column_cut is 0 has no groups.
 *
 * In T and V blocks of the shown layer a frame may leave out columns. With the largest value of a
 * column per unit of light
 *
 *     reach = column_scale * (32767 or 127) * max(1, largest tint)
 *
 * it may leave out
 *
 *     the column of light i  where X_i,c * reach < cut_share * column_cut, or, if its group k has
 *                            a column, |X_i,c - q_i S_k,c| * reach < cut_share * column_cut
 *     the column of group k  where S_k,c * reach < cut_share * basis_group_cut()
 *
 * in every channel c. column_cut is a number of the file, cut_share one of the block. X is linear
 * light, gain included, for T, and a share of all light on the ground for V.
 *
 * Blocks add up: the shadow (one channel) and the light that the object reflects onto the ground
 * (three channels) may be two V blocks over the same pixels.
 *
 * The object does not change a pixel that no block of its tile lists and whose coverage is 0. In a
 * pixel that is covered and has no T row the object is black.
 *
 * A pose has up to two layers. BLCK and DATA are the shown layer, within the declared errors. BLCX
 * and DATX, which may be absent, are the exact layer, the reference: a column of 16 bits for every
 * light, without patterns.
 *
 * A reader accepts a file only if all rules of README.md hold.
 */
#ifndef INLAY_HAL_BASIS_BASIS_FORMAT_H
#define INLAY_HAL_BASIS_BASIS_FORMAT_H

#include <stdint.h>

#define BASIS_MAGIC "INLAYBAS"
#define BASIS_VERSION 10
#define BASIS_PAGE 4096
#define BASIS_ALIGN 64 /* alignment of every array inside a block, in bytes */

#define BASIS_LIGHTS_MAX 32768
#define BASIS_SIDE_MAX 16384
/* Side of a tile in pixels. Tiles are in row-major order; the right and lower picture edge cut
 * them. */
#define BASIS_TILE 16
#define BASIS_GROUNDS_MAX 256
#define BASIS_GROUND_MAX 1e30 /* largest u: no sum of u L overflows */
#define BASIS_CHUNKS_MAX 65536
#define BASIS_POSES_MAX 8192
#define BASIS_POSE_NAME_MAX 32	/* with its NUL */
#define BASIS_PATTERNS_MAX 1024 /* in a block */
/* Largest value per unit of X, before the tint. The reader checks
 *     column of 16 bits   scale * 32767
 *     column of 8 bits    scale * 127
 *     pattern j           scale * 32767 * sum over k of |pattern[j,k]|
 */
#define BASIS_VALUE_MAX 65536.0
#define BASIS_TINT_ONE 32768
/* Sum of the three weights with which a light goes to coarse lights. */
#define BASIS_COARSE_ONE 32768

struct basis_file_header {
	char magic[8];
	uint32_t version;
	uint32_t chunk_count;
	uint64_t file_bytes;
	uint64_t checksum; /* XXH3-64 of header (with 0 in this field) and chunk table */
};

struct basis_chunk_entry {
	uint32_t type; /* enum basis_chunk */
	uint32_t pose; /* 0 for a chunk that all poses share */
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
	/* struct basis_coarse [lights]; absent when coarse == lights: each light is a coarse light
	 * */
	BASIS_CHUNK_COARSE = BASIS_FOURCC('C', 'O', 'A', 'R'),
	/* BLCK, BLCX: struct basis_block_entry[]; DATA, DATX: the payloads of these blocks */
	BASIS_CHUNK_BLOCKS = BASIS_FOURCC('B', 'L', 'C', 'K'),
	BASIS_CHUNK_DATA = BASIS_FOURCC('D', 'A', 'T', 'A'),
	BASIS_CHUNK_EXACT_BLOCKS = BASIS_FOURCC('B', 'L', 'C', 'X'),
	BASIS_CHUNK_EXACT_DATA = BASIS_FOURCC('D', 'A', 'T', 'X'),
	/* float [lights + 1][3]: largest radiance of any pixel of the object per unit of L_i; last
	 * row: the largest where L_i = 1 for all i */
	BASIS_CHUNK_PEAK = BASIS_FOURCC('P', 'E', 'A', 'K'),
	/* replaces COVR and DATA of a packed pose: struct basis_pack, struct basis_pack_part
	 * [parts], coverage, streams of the parts */
	BASIS_CHUNK_PACK = BASIS_FOURCC('P', 'A', 'C', 'K'),
	/* struct basis_glass []: pixels that show the background through the object; may be absent
	 * */
	BASIS_CHUNK_GLASS = BASIS_FOURCC('G', 'L', 'A', 'S'),
	/* struct basis_pose_name [poses]; may be absent */
	BASIS_CHUNK_POSES = BASIS_FOURCC('P', 'O', 'S', 'E'),
	/* struct basis_places, packed maps; may be absent */
	BASIS_CHUNK_PLACES = BASIS_FOURCC('P', 'L', 'A', 'C'),
	/* struct basis_footprint [poses]; may be absent */
	BASIS_CHUNK_FOOT = BASIS_FOURCC('F', 'O', 'O', 'T'),
	/* Texts end in a NUL byte, their only one. */
	BASIS_CHUNK_CAMERA = BASIS_FOURCC('C', 'A', 'M', 'R'),	   /* the camera as INI */
	BASIS_CHUNK_PROVENANCE = BASIS_FOURCC('P', 'R', 'O', 'V'), /* key = value lines */
};

/* A line of the provenance, not its first: the file has few lights and samples, and stands in for a
 * bake that is not finished yet. */
#define BASIS_PREVIEW_LINE "preview = yes\n"

struct basis_info_chunk {
	uint32_t width, height;
	uint32_t lights;
	/* The base dome's, for information: chunk DOME has the nodes, also of finer parts. 0:
	 * unknown. */
	uint32_t dome_frequency;
	uint32_t dome_division; /* 0; earlier versions wrote 1 for a dome by equal chords */
	uint32_t grounds;
	uint32_t poses;	      /* >= 1 */
	uint32_t coarse;      /* K, 1..lights */
	uint32_t light_shape; /* 0; 1 in earlier versions: hat functions, which are refused */
	uint32_t reserved;    /* 0 */
	/*
	 * Declared errors. None of them contains the error of dividing the sky into N lights.
	 *
	 * column_cut: a frame may leave out a column that changes no pixel by more than this times
	 * the block's cut_share, in linear light (T, white is 1) or in the ratio (V). For columns
	 * of groups basis_group_cut() takes the place of column_cut. The measured errors include
	 * that.
	 *
	 * Bounds for any lighting if every column is used, quantisation and cuts of the encoder
	 * together:
	 *   object_error  |error of O| <= this * sum over i of X_i
	 *   ratio_error   |error of the ratio| <= this (V blocks)
	 * Measured by the bake against its own transport before any cut, in 8-bit sRGB levels over
	 * stored pixels. The background is the ground's own light, or white where a single cell is
	 * lit (bake/judge/ensemble.h), and nothing is overexposed: level white ground and the
	 * object's brightest spot are at most 1:
	 *   sky_rms, sky_max    the worst of an ensemble of lightings: overcast, suns, random
	 *   cell_rms, cell_max  every cell lit alone (RMS over all of them); cell_max also with
	 *                       1/16 of its light from an even sky, in some cells
	 * noise_levels  estimated standard error of the render, in 8-bit sRGB levels, RMS over
	 *               the pixels that the object changes, under the ensemble's suns; 0: unknown
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

/* Column i of P times BASIS_COARSE_ONE: the three coarse lights of light i, in ascending order.
 * Unused entries have index 0 and weight 0 and come last. */
struct basis_coarse {
	uint16_t index[3];
	uint16_t weight[3];
};

/* Name of a pose: letters, digits, - and _, not digits alone, unique in its file, padded with
 * zeros. Empty: the pose has no name. */
struct basis_pose_name {
	char text[BASIS_POSE_NAME_MAX];
};

/*
 * What the object covers of the ground Z = 0, seen from above, for telling who stands before it and
 * who behind: of its parts between the ground and the camera's height, or of all where there is
 * nothing between, because people walk below what is higher. Square (i, j), bit i of row[j], covers
 *
 *     corner + side * (i..i+1, j..j+1)        in the scene's X and Y
 *
 * and is set where any surface of the object is above it; what is hollow may be unset inside. side
 * 0, and no bit: there is no object.
 */
#define BASIS_FOOT_SQUARES 64
#define BASIS_FOOT_MOST 1e9F /* of |corner| and side */

struct basis_footprint {
	float corner[2], side;
	uint32_t reserved; /* 0 */
	uint64_t row[BASIS_FOOT_SQUARES];
};

/*
 * Where the surfaces of a pose's pixels lie, for light that depends on the place. For each kind of
 * surface a map [height][width] of
 *
 *     round(BASIS_PLACE_ONE nearest / distance), at least 1; 0: the surface is not in the pixel
 *
 * where distance is from the camera, the mean over the pixel's samples, in world units. Of
 * BASIS_BOUNCED it is the reciprocal of a share: that of the object's light under an even sky which
 * comes by way of other surfaces. Receivers are those of D and U; the ground of V lies at Z = 0,
 * and needs no map. A map is one zstd frame: the upper bytes, then the lower bytes, of the
 * differences modulo 2^16 from left + upper - upper left neighbour.
 */
#define BASIS_PLACE_ONE 65535

enum basis_surface { BASIS_OBJECT, BASIS_RECEIVER, BASIS_BOUNCED, BASIS_SURFACES };

/* The maps follow in their order. */
struct basis_places {
	float nearest[BASIS_SURFACES];	/* the smallest distance */
	uint32_t bytes[BASIS_SURFACES]; /* of the packed map; 0: the surface is in no pixel */
};

/*
 * A pixel in which the background B is seen through the object, straight or bent:
 *
 *     out = O + ratio * ((1 - coverage) * B(x, y) + transmission * B(x + dx, y + dy))
 *
 * transmission is the share of the background's light that arrives, averaged over the whole pixel
 * like T. Samples that see no background through the object count as 0. Glass counts as covering,
 * so transmission is at most coverage. B(x + dx, y + dy) is the mean of the background, in linear
 * light, over a rectangle around the pixel's centre moved by the offset; edge pixels repeat beyond
 * the picture. Its sides are 1 + spread / BASIS_GLASS_SPREAD pixels, so straight glass shows the
 * pixel itself. ratio comes from the pixel's own V, or D and U: these average the real surfaces
 * seen beside the object (each sample has weight 1) and through it (each sample has the mean of its
 * three transmissions as weight). Samples of the background without a real surface count as
 * unchanged.
 */
#define BASIS_GLASS_STEP 16  /* steps of an offset in one pixel */
#define BASIS_GLASS_SPREAD 4 /* steps of a spread in one pixel */

/* Sorted by tile, then y, then x; no pixel twice. */
struct basis_glass {
	uint16_t x, y;		  /* in the picture */
	uint16_t transmission[3]; /* 65535 = 1 */
	int16_t dx, dy;
	uint8_t spread[2]; /* across, down */
};

enum basis_kind { BASIS_KIND_T, BASIS_KIND_V, BASIS_KIND_D, BASIS_KIND_U, BASIS_KIND_COUNT };

/*
 * The payload of a block. Each array starts at a multiple of BASIS_ALIGN; padding is 0
 * (basis_layout.h).
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
 * A panel is as many consecutive pixels of the block's list as fill a cache line:
 *
 *     panels16 = ceil(pixels / 32), panels8 = ceil(pixels / 64)
 *
 * Places after the last pixel hold 0. A line (64 bytes) is one pattern or column in one panel and
 * channel. A frame reads a line as a whole or not at all. It reads most columns of 16 bits, panel
 * by panel and all channels at once: three sequential streams, which the processor prefetches. It
 * reads few columns of 8 bits; so each of these is contiguous, a record in which each line is as
 * short as possible. Records are in the order of columns, without gaps. The values -32768, -128 and
 * (of 4 bits) 15 do not occur.
 *
 * Every pixel of a D block is in a U block of its tile. No light alone makes U negative by more
 * than quantisation.
 */
/* Sorted by tile, then by kind; offsets ascend too. */
struct basis_block_entry {
	uint32_t tile;
	uint8_t kind;
	uint8_t channels; /* 3, or 1 where all three share their rows */
	uint8_t bits;	  /* of a value in a column: 8 or 16; 16 where there are no columns */
	uint8_t tinted;	  /* 1: has a tint; only where channels is 1 */
	uint16_t pixels;  /* 1..BASIS_TILE^2 */
	uint16_t patterns;
	uint32_t columns;      /* 0..N + K; patterns + columns >= 1 */
	uint32_t ground;       /* V: index of its shared ground term; else 0 */
	uint32_t record_bytes; /* length of all records; 0 where bits is 16 */
	/* Share of column_cut, and of the cut of groups, below which a frame may leave out columns
	 * of this block: above 0, at most 1. Without effect where no column is left out: in D and
	 * U, and in the exact layer. */
	float cut_share;
	uint32_t reserved; /* 0 */
	uint64_t offset;   /* in the DATA or DATX chunk, a multiple of BASIS_ALIGN */
	uint64_t bytes;
};

/*
 * A file of several poses shows one at a time, so poses may be packed. PACK holds the same as COVR
 * and DATA: all payloads without gaps, in parts of some blocks each. A part is four streams; each
 * is one zstd frame (RFC 8878), or absent where it is empty:
 *
 *     0  pixel, tint, pattern_scale, light and column_scale with their padding, unchanged
 *     1  upper bytes of all 16-bit values: patterns, coefficients, columns
 *     2  lower bytes of the same
 *     3  records of columns of 8 bits; record_at follows from them
 *
 * Streams 1 to 3 hold a value v in zigzag form, modulo 2^8 or 2^16:
 *
 *     v >= 0: 2v        v < 0: -2v - 1
 *
 * Of coefficients and 16-bit columns v is the difference from the value before (0 before the first
 * value of an array). Of a whole 8-bit line, v is the difference from the value before in the same
 * row of BASIS_TILE values; the first of a row is the difference from the first of the row before.
 * Codes and short lines are unchanged.
 */
#define BASIS_PACK_STREAMS 4

struct basis_pack {
	uint64_t data_bytes; /* length of the unpacked DATA */
	uint32_t parts;
	uint32_t coverage_bytes; /* packed: one zstd frame of COVR */
};

struct basis_pack_part {
	uint32_t blocks;		    /* how many blocks of the list it holds; >= 1 */
	uint32_t bytes[BASIS_PACK_STREAMS]; /* packed */
	uint32_t reserved;		    /* 0 */
};

#endif
