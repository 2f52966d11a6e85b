/* SPDX-License-Identifier: MIT */
/*
 * The report of a geometric calibration: a folder with one self-contained page (report.html:
 * verdict, pictures, plots, tables), the same pictures and tables as files, and calibration.json
 * for programs.
 */
#ifndef INLAY_BAKE_CALIBRATE_REPORT_REPORT_H
#define INLAY_BAKE_CALIBRATE_REPORT_REPORT_H

#include "bake/calibrate/estimate/finding.h"
#include "hal/image/image.h"

/*
 * Writes the report. pictures: [finding->seen->views] or NULL; pictures[v] is the 8-bit photograph
 * of view v, of the finding's size, or NULL: its points are then drawn on plain grey. If the
 * finding's size is not known (0), that of the first picture is used, or one that holds all points.
 *
 * An untrusted finding is reported too; values that are not finite are shown as not known. An
 * earlier report in the folder is replaced at once. -EEXIST: the folder holds other things;
 * -EINVAL: a picture of another size or kind; -ENOMEM; -errno of writing.
 */
int calibration_report_write(const char *folder, const struct finding *finding,
			     const struct image *const *pictures, struct fault *fault);

#endif
