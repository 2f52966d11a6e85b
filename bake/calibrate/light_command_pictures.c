/* SPDX-License-Identifier: MIT */
/* inlay-calibrate light black and response. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/calibrate/bracket/light_rsp.h"
#include "bake/calibrate/light_job.h"
#include "bake/calibrate/response/light_black.h"
#include "bake/calibrate/response/light_file.h"
#include "bake/calibrate/response/light_report.h"
#include "bake/calibrate/response/light_response.h"
#include "hal/base/log.h"

/* Checks a picture here, where the name of its file is known. */
static int check_light_picture(const struct light_job *job, const struct image *pictures, int k,
			       struct fault *fault)
{
	const struct image *first = &pictures[0], *p = &pictures[k];

	if (!p->u8)
		return fault_say(fault, -EINVAL,
				 "%s: the picture holds linear light, expected an 8-bit picture",
				 job->files[k]);
	if (p->width != first->width || p->height != first->height)
		return fault_say(
			fault, -EINVAL,
			"%s: the picture is %dx%d pixels, that of %s %dx%d; expected one size",
			job->files[k], p->width, p->height, job->files[0], first->width,
			first->height);
	return 0;
}

int light_read_pictures(const struct light_job *job, struct image *pictures, struct fault *fault)
{
	int err = 0;

	for (int k = 0; k < job->file_count && !err; k++) {
		err = image_read(job->files[k], &pictures[k], fault);
		if (!err)
			err = check_light_picture(job, pictures, k, fault);
	}
	return err;
}

void light_free_pictures(struct image *pictures, int count)
{
	for (int k = 0; k < count; k++)
		image_free(&pictures[k]);
}

static int find_black(const struct light_job *job, struct light_black *black, struct fault *fault)
{
	struct image picture = {.width = 0};
	struct fault why = {.text = ""};
	int err = light_read_pictures(job, &picture, fault);

	if (!err) {
		err = light_black_covered(black, &picture, &why);
		if (err)
			fault_say(fault, err, "%s: %s", job->files[0], why.text);
	}
	image_free(&picture);
	return err;
}

int light_check_black(const struct light_job *job, struct fault *fault)
{
	if (job->file_count == 1)
		return 0;
	return fault_say(fault, -EINVAL, "expected one picture, taken with the lens covered");
}

int light_command_black(const struct light_job *job, struct fault *fault)
{
	struct light_black black;
	char text[64], comment[256];
	int err;

	err = find_black(job, &black, fault);
	if (err)
		return err;
	printf("black level %.3f, deviation %.3f; a pixel's noise %.2f codes; R G B %.2f %.2f %.2f\n",
	       black.level, black.deviation, black.noise, black.channel[0], black.channel[1],
	       black.channel[2]);
	if (job->report) {
		err = light_report_black(job->report, &black, fault);
		if (err)
			return err;
	}
	if (black.verdict.trusted && job->measured.knot[TRANSFER_KNOTS - 1] > 0 &&
	    !(job->measured.black_level == black.level))
		log_warning(
			"%s: its response was measured with another black level; measure it again",
			job->output);
	snprintf(text, sizeof(text), "%.4g", black.level);
	snprintf(comment, sizeof(comment),
		 "Black level: deviation %.3f, a pixel's noise %.2f codes.", black.deviation,
		 black.noise);
	return light_conclude(job, &black.verdict, "black_level", text, comment, fault);
}

/* ---- response ---- */

static void write_knots(const struct light_response *found, char *text, size_t room)
{
	size_t used = 0;

	for (int k = 0; k < TRANSFER_KNOTS && used < room; k++)
		used += (size_t)snprintf(text + used, room - used, "%s%.6g", k ? " " : "",
					 found->curve.knot[k]);
}

static void write_response_comment(const struct light_response *found, char *text, size_t room)
{
	snprintf(
		text, room,
		"Response: %d places in %d exposures, codes from %.0f %% to %.0f %%; off by at most %.2f %%\n"
		"between 10 %% and 90 %% (one deviation); what is left is %.2f times what noise explains.",
		found->samples, found->exposures, 100 * found->from, 100 * found->to,
		100 * found->misfit, found->sigma);
}

static int shortest_exposure(const double *time, int count)
{
	int shortest = 0;

	for (int k = 1; k < count; k++)
		if (time[k] < time[shortest])
			shortest = k;
	return shortest;
}

static int find_response(const struct light_job *job, struct light_response *found,
			 struct fault *fault)
{
	struct image pictures[LIGHT_EXPOSURES_MAX] = {{.width = 0}};
	const struct image *list[LIGHT_EXPOSURES_MAX];
	struct light_response_settings settings = {.time_deviation = job->time_deviation,
						   .misfit = job->misfit_percent / 100};
	struct light_samples samples = {.sample = NULL};
	double black = job->measured.black_level;
	int err = light_times(job, settings.time, fault);

	if (!err)
		err = light_read_pictures(job, pictures, fault);
	for (int k = 0; k < job->file_count; k++)
		list[k] = &pictures[k];
	if (!err && black < 0) {
		black = light_darkest_code(
			&pictures[shortest_exposure(settings.time, job->file_count)]);
		if (black > 0)
			log_info(
				"the black level is taken for %g, the darkest place of the shortest exposure; inlay-calibrate light black measures it",
				black);
	}
	if (!err)
		err = light_samples_create(&samples, list, job->file_count, black > 0 ? black : 0,
					   fault);
	if (!err)
		err = light_response_find(found, &samples, &settings, fault);
	light_samples_free(&samples);
	light_free_pictures(pictures, job->file_count);
	return err;
}

static void say_response(const struct light_response *found)
{
	printf("%d places, %d pieces; left over %.2f of what noise explains; held out %.2f\n",
	       found->samples, found->spline.pieces, found->sigma, found->held_out);
	printf("off by at most %.2f %% of linear light between 10 %% and 90 %% (one deviation); exposures differ by %.2f %%%s\n",
	       100 * found->misfit, 100 * found->disagreement,
	       found->refined ? "; times in steps of a third of a stop, as shutters have them"
			      : "");
	for (int j = 0; j < found->exposures; j++)
		printf("exposure %d: time %.5g, off by %+.2f %%, scatter %.2f %%\n", j + 1,
		       found->time[j], 100 * found->offset[j], 100 * found->scatter[j]);
	for (int c = 0; c < 3; c++)
		printf("channel %c: off by %.2f %% at most, deviation %.2f %%\n", "RGB"[c],
		       100 * found -> channel_off[c], 100 * found -> channel_deviation[c]);
}

int light_check_response(const struct light_job *job, struct fault *fault)
{
	if (job->file_count == 1 && light_is_rsp(job->files[0]) && !job->times)
		return 0;
	return light_check_times(job, fault);
}

/* Takes hdrgen's curve as it is. */
static int import_rsp(const struct light_job *job, struct fault *fault)
{
	struct light_response found = {.samples = 0};
	char text[1024], comment[512];
	double apart;
	int err = light_rsp_read(job->files[0], &found.curve, &apart, fault);

	if (err)
		return err;
	write_knots(&found, text, sizeof(text));
	snprintf(comment, sizeof(comment),
		 "Response: of hdrgen's %s, whose channels differ by %.2f %%.", job->files[0],
		 100 * apart);
	printf("%s\n", comment);
	verdict_begin(&found.verdict);
	if (apart > LIGHT_MISFIT && !(100 * apart <= job->misfit_percent))
		verdict_doubt(
			&found.verdict, "give --accept-misfit if that is good enough",
			"%s: its channels differ by %.1f %% from their mean, which is one curve here",
			job->files[0], 100 * apart);
	return light_conclude(job, &found.verdict, "response", text, comment, fault);
}

int light_command_response(const struct light_job *job, struct fault *fault)
{
	struct light_response found = {.samples = 0};
	char text[1024], comment[512];
	int err;

	if (job->file_count == 1)
		return import_rsp(job, fault);
	err = find_response(job, &found, fault);
	if (err)
		return err;
	say_response(&found);
	if (job->report)
		err = light_report_response(job->report, &found, fault);
	write_knots(&found, text, sizeof(text));
	write_response_comment(&found, comment, sizeof(comment));
	if (!err)
		err = light_conclude(job, &found.verdict, "response", text, comment, fault);
	/* the response counts from the black level, which nobody has measured */
	if (!err && job->output && job->measured.black_level < 0 && found.curve.black > 0) {
		snprintf(text, sizeof(text), "%g", found.curve.black);
		err = light_file_set(job->output, "black_level", text,
				     "Black level: the darkest place of the response's pictures.",
				     fault);
	}
	light_response_free(&found);
	return err;
}
