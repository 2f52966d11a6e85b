/* SPDX-License-Identifier: MIT */
/* Any bytes as a file of a camera's response: refused in a sentence, or a curve that ascends from 0
 * to 1.
 *
 * reaches: response.c:response_read response.c:response_curve
 */
#include <math.h>
#include <stdlib.h>

#include "hal/colour/response.h"
#include "tests/support/as_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct ini_report report = {.count = 0};
	struct response response;
	struct transfer_curve curve;

	response_begin(&response);
	if (response_read(&response, as_file(data, bytes), &report)) {
		if (!report.count || !report.first.text[0])
			abort();
		return 0;
	}
	curve = response_curve(&response, TRANSFER_SRGB, 0);
	for (int code = 0; code < 256; code++)
		if (!isfinite(transfer_curve_decode(&curve, code)))
			abort();
	if (!(response_gain(&response, 1) > 0))
		abort();
	return 0;
}
