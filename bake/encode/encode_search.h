/* SPDX-License-Identifier: MIT */
/* Searches for the cheapest plan that holds the error asked for: the numbers of patterns, and the
 * lights that get a column. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_SEARCH_H
#define INLAY_BAKE_ENCODE_ENCODE_SEARCH_H

#include "bake/encode/encode_plan.h"

int search_create(struct search *search, const struct encode_settings *settings,
		  const struct levels *levels);
void search_free(struct search *search); /* zeroed is fine */

/* Finds the best plan for a part. Leaves the split at the plan's ranks. -ENOMEM. */
int search_best(struct search *search, struct split *split, const struct part *part,
		struct encode_plan *best);

#endif
