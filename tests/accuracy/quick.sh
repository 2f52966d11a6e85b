#!/bin/bash
# SPDX-License-Identifier: MIT
# A few cells of the accuracy table, and a small one of settings within a time, as tests; with INLAY_THOROUGH a low sun, too.
cd "$(dirname "$0")" || exit 1
for table in panoramas within ${INLAY_THOROUGH:+low_sun}; do
	./$table.sh --quick || exit
done
