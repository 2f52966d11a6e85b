/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/fisheye_file.h"

#include "bake/calibrate/estimate/lens_ini.h"
#include "hal/base/output.h"

void fisheye_print(FILE *to, const char *before, const struct fisheye_result *result)
{
	const struct finding *finding = &result->finding;

	finding_print(to, before, finding);
	if (!finding->estimate.count)
		return;
	for (int k = 0; k < finding->estimate.count; k++)
		if (!finding->estimate.parameter[k].fixed)
			estimate_print(to, before, &finding->estimate, k);
	if (!result->oriented)
		fprintf(to, "%show it is turned towards the world was not found: rotation is 0\n",
			before);
}

void falloff_print(FILE *to, const char *before, const struct falloff *falloff)
{
	char sentence[VERDICT_SENTENCE_MAX];

	verdict_sentence(&falloff->verdict, sentence, sizeof(sentence));
	fprintf(to, "%sfalloff: %s\n", before, sentence);
	for (int k = 0; k < FISHEYE_FALLOFF_TERMS; k++)
		fprintf(to, "%sv%d = %.6g +- %.2g\n", before, k + 1, falloff->v[k],
			falloff->deviation[k]);
	fprintf(to, "%slight at the rim: %.3g of that on the axis; spread %.2g\n", before,
		falloff->rim, falloff->spread);
}

int fisheye_file_write(const char *path, const struct fisheye_settings *lens,
		       const struct fisheye_result *result, const struct falloff *falloff,
		       struct fault *fault)
{
	struct output out = {.stream = NULL};
	int err = output_open(&out, path, fault);

	if (err)
		return err;
	fputs("; A fisheye lens, by inlay-calibrate fisheye. After +- stands one standard deviation.\n",
	      out.stream);
	if (result)
		fisheye_print(out.stream, "; ", result);
	if (falloff)
		falloff_print(out.stream, "; ", falloff);
	lens_write_keys(out.stream, "fisheye", fisheye_keys, lens);
	err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}
