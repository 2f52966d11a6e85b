/* SPDX-License-Identifier: MIT */
/*
 * Looks into an access unit of H.264 for what libavcodec does not tell: where its parameter sets
 * are, and whether one that it is decoded from is missing. Reference pictures are counted by
 * frame_num (H.264 7.4.3); libavcodec makes a missing one up. Pure.
 */
#ifndef INLAY_DRIVERS_V4L2_H264_UNIT_H
#define INLAY_DRIVERS_V4L2_H264_UNIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* State of a stream; zeroed: nothing was seen yet. */
struct h264_count {
	unsigned bits;	    /* of frame_num; 0: not known */
	bool begun;	    /* reference is valid */
	unsigned reference; /* frame_num of the last reference picture */
};

struct h264_unit {
	bool picture;	/* it holds a part of a picture */
	bool gap;	/* a picture that this one may need is missing */
	bool sequence;	/* the parameter sets begin with that of the sequence */
	size_t sets_at; /* where they begin, with a start code */
	size_t sets_bytes;
};

/* Reads an access unit, with start codes; any bytes. */
struct h264_unit h264_unit_read(struct h264_count *count, const uint8_t *data, size_t bytes);

#endif
