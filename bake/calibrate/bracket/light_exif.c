/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/bracket/light_exif.h"

#include <errno.h>
#include <limits.h>
#include <stddef.h>
#include <stdlib.h>

#include <libexif/exif-data.h>

#include "hal/base/input.h"

/* A rational or a short number of a tag; 0: not there. */
static double number_of(ExifData *data, ExifTag tag)
{
	const ExifEntry *entry = exif_data_get_entry(data, tag);
	ExifByteOrder order = exif_data_get_byte_order(data);
	ExifRational r;

	if (!entry || !entry->components)
		return 0;
	if (entry->format == EXIF_FORMAT_SHORT && entry->size >= 2)
		return exif_get_short(entry->data, order);
	if (entry->format != EXIF_FORMAT_RATIONAL || entry->size < 8)
		return 0;
	r = exif_get_rational(entry->data, order);
	return r.denominator ? (double)r.numerator / r.denominator : 0;
}

int light_exif_exposure(const char *path, double *exposure, struct fault *fault)
{
	double time = 0, iso = 0, f_number = 0;
	ExifData *data;
	uint8_t *file;
	size_t bytes;
	const int err = input_read(path, UINT_MAX, &file, &bytes, fault);

	if (err)
		return err;
	data = exif_data_new_from_data(file, (unsigned)bytes);
	free(file);
	if (data) {
		time = number_of(data, EXIF_TAG_EXPOSURE_TIME);
		iso = number_of(data, EXIF_TAG_ISO_SPEED_RATINGS);
		f_number = number_of(data, EXIF_TAG_FNUMBER);
		exif_data_unref(data);
	}
	if (!(time > 0))
		return fault_say(fault, -ENODATA,
				 "%s: says no exposure time (EXIF), expected --times", path);
	*exposure = time * (iso > 0 ? iso / 100 : 1) / (f_number > 0 ? f_number * f_number : 1);
	return 0;
}
