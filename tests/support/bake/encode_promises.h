/* SPDX-License-Identifier: MIT */
/*
 * What the encoder promises of its blocks, checked in double precision against an encode_rig_part:
 * the declared bounds, the errors in levels for each cell and each lighting of the ensemble, the
 * columns of groups, and the format.
 */
#ifndef INLAY_TESTS_SUPPORT_BAKE_ENCODE_PROMISES_H
#define INLAY_TESTS_SUPPORT_BAKE_ENCODE_PROMISES_H

#include "tests/support/bake/encode_rig.h"
#include "tests/support/chance.h"

/* Largest difference between truth and decoded values, per unit of X. */
double encode_promises_difference(const struct encode_rig *e, const struct encode_rig_part *part);

/* Fails the test where a block breaks a rule of basis_format.h. */
void encode_promises_format(const struct encode_rig *e, const struct encode_result *result);

/*
 * Encodes one part and fails the test where any promise is broken. Where chance is not NULL, random
 * lightings from outside the ensemble are tried too. Of kind T this changes part->decoded.
 */
struct encode_result encode_promises_hold(struct encode_rig *e, struct encode_rig_part *part,
					  struct chance *chance);

#endif
