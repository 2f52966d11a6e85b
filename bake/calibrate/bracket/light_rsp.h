/* SPDX-License-Identifier: MIT */
/*
 * hdrgen's response files (.rsp): for R, G and B a line with the order of a polynomial and its
 * coefficients, the highest first,
 *     linear light = c_n u^n + ... + c_0,   u = code value / 255
 */
#ifndef INLAY_BAKE_CALIBRATE_BRACKET_LIGHT_RSP_H
#define INLAY_BAKE_CALIBRATE_BRACKET_LIGHT_RSP_H

#include "hal/base/fault.h"
#include "hal/colour/transfer.h"

/* Reads a file as a measured curve, the mean of its channels scaled to 1 at the upper end; *apart:
 * the largest relative difference of a channel from it between 10 % and 90 %. -EINVAL: not such a
 * file, or a curve that does not ascend; -ENOENT... */
int light_rsp_read(const char *path, struct transfer_curve *curve, double *apart,
		   struct fault *fault);

#endif
