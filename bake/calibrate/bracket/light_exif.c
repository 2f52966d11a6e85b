/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/bracket/light_exif.h"

#include <errno.h>
#include <stddef.h>

#include <libexif/exif-data.h>

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
	ExifData *data = exif_data_new_from_file(path);
	const double time = data ? number_of(data, EXIF_TAG_EXPOSURE_TIME) : 0;
	const double iso = data ? number_of(data, EXIF_TAG_ISO_SPEED_RATINGS) : 0;
	const double f_number = data ? number_of(data, EXIF_TAG_FNUMBER) : 0;

	if (data)
		exif_data_unref(data);
	if (!(time > 0))
		return fault_say(fault, -ENODATA,
				 "%s: says no exposure time (EXIF), expected --times", path);
	*exposure = time * (iso > 0 ? iso / 100 : 1) / (f_number > 0 ? f_number * f_number : 1);
	return 0;
}
