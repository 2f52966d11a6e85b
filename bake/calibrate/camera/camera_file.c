/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_file.h"

#include "bake/calibrate/camera/camera_parts.h"
#include "bake/calibrate/estimate/lens_ini.h"
#include "hal/base/output.h"

void camera_print(FILE *to, const char *before, const struct camera_solution *solution)
{
	const struct finding *finding = &solution->finding;

	finding_print(to, before, finding);
	if (!solution->solved)
		return;
	for (int k = 0; k < MODEL_SHARED; k++)
		estimate_print(to, before, &finding->estimate, k);
	for (int k = 0; k < MODEL_OF_VIEW; k++)
		estimate_print(to, before, &finding->estimate,
			       model_of_view(solution->own->task.reference) + k);
	for (int i = 0; i < finding->seen->count; i++)
		if (finding->weight[i] < 0.1)
			fprintf(to, "%sleft out: %s\n", before, finding->seen->point[i].name);
}

int camera_file_write(const char *path, const struct camera_solution *solution, struct fault *fault)
{
	struct output out = {.stream = NULL};
	int err = output_open(&out, path, fault);

	if (err)
		return err;
	fputs("; The background camera, by inlay-calibrate camera. What follows is one standard\n"
	      "; deviation; centre y is counted downwards here.\n",
	      out.stream);
	camera_print(out.stream, "; ", solution);
	lens_write_keys(out.stream, "camera", tsai_keys, &solution->camera);
	err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}
