/*
 * Transfer functions: between 8-bit code values and linear light.
 *
 * Linear 1.0 is the radiance that code 255 stands for. Fixed-point linear light is Q16 with
 * 1.0 = 65535 ("U16 linear"); an unclipped intermediate may exceed it.
 */
#ifndef INLAY_HAL_TRANSFER_H
#define INLAY_HAL_TRANSFER_H

#include <stdint.h>

#include "hal/fault.h"

enum transfer {
	TRANSFER_SRGB,	 /* IEC 61966-2-1 */
	TRANSFER_BT709,	 /* ITU-R BT.709-6, table 3: item 1.2 (camera side) and its inverse */
	TRANSFER_LINEAR, /* code / 255 */
	TRANSFER_COUNT
};

extern const char *const transfer_names[]; /* "srgb", "bt709", "linear", NULL */

/* The functions themselves, in double precision: encoded and linear both in 0..1; outside that
 * range the argument is clamped. The inverse pair agrees to 1e-12. */
double transfer_decode(enum transfer t, double encoded);
double transfer_encode(enum transfer t, double linear);

/*
 * decode[c] = round(65535 * linear(c));
 * encode[v] = round(255 * encoded(v / 65535)), so encode[decode[c]] == c for every c.
 */
struct transfer_tables {
	uint16_t decode[256];
	uint8_t encode[65536];
};

void transfer_tables_fill(struct transfer_tables *tables, enum transfer t);

#endif
