/* SPDX-License-Identifier: MIT */
/* How many patterns, and which lights get a column: the cheapest that holds the error asked for.
 * Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_SEARCH_H
#define INLAY_BAKE_ENCODE_ENCODE_SEARCH_H

#include "bake/encode/encode_plan.h"

int search_create(struct search *search, const struct encode_settings *settings,
		  const struct levels *levels);
void search_free(struct search *search); /* zeroed is fine */

/* The best plan for the part, its split ready and its ranks set. -ENOMEM. */
int search_best(struct search *search, struct split *split, const struct part *part,
		struct encode_plan *best);

#endif
