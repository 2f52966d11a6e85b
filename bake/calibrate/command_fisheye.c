/* SPDX-License-Identifier: MIT */
/* inlay-calibrate fisheye: the lens that looks at the sky. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/commands.h"
#include "bake/calibrate/estimate/lens_ini.h"
#include "bake/calibrate/fisheye/circle/fisheye_circle.h"
#include "bake/calibrate/fisheye/fisheye_falloff.h"
#include "bake/calibrate/fisheye/fisheye_find.h"
#include "bake/calibrate/lens_job.h"
#include "hal/base/output.h"

/* Print the result as lines that begin with before. */
static void fisheye_print(FILE *to, const char *before, const struct fisheye_result *result)
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

static void falloff_print(FILE *to, const char *before, const struct falloff *falloff)
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

/* Writes an INI file with a section [fisheye] and the results as comments; result and falloff may
 * be NULL. -errno. */
static int fisheye_file_write(const char *path, const struct fisheye_settings *lens,
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

/* fisheye_model_names, and auto */
static const char *const model_names[] = {
	"equidistant", "equisolid", "stereographic", "orthographic", "polynomial", "auto", NULL};

struct fisheye_job {
	struct lens_job lens;
	struct fisheye_wanted wanted;
	const char *live, *circle, *known; /* the source, else pictures of a board */
	const char *board, *world, *uniform;
	int views;
	double rim_deg;
	bool rotation_given;
	double rotation_deg[3];
};

/* ---- options ---- */

static int read_images(void *field, const char *option, const char *text, struct fault *fault)
{
	struct lens_job *lens = field;

	(void)option;
	(void)fault;
	lens->more = true;
	lens->file[lens->files++] = (char *)text;
	return 0;
}

static int read_rotation(void *field, const char *option, const char *text, struct fault *fault)
{
	const int count = option_reals(option, text, 3, 3, -360, 360, field, fault);

	return count < 0 ? count : 0;
}

#define AT(field) .place = offsetof(struct fisheye_job, field)

static const struct option_row rows[] = {
	{"images", OPTION_OTHER, AT(lens), .take = read_images},
	{"live", OPTION_TEXT, AT(live)},
	{"circle", OPTION_TEXT, AT(circle)},
	{"lens", OPTION_TEXT, AT(known)},
	{"board", OPTION_TEXT, AT(board)},
	{"views", OPTION_INT, AT(views), .min = 1, .max = 1000},
	{"world", OPTION_TEXT, AT(world)},
	{"rotation", OPTION_OTHER, AT(rotation_deg), .take = read_rotation,
	 .given = offsetof(struct fisheye_job, rotation_given)},
	{"rim-deg", OPTION_REAL, AT(rim_deg), .min = 10, .max = 170},
	{"field", OPTION_REAL, AT(wanted.field_deg), .min = 1, .max = 180},
	{"model", OPTION_CHOICE, AT(wanted.model), .choices = model_names},
	{"uniform", OPTION_TEXT, AT(uniform)},
	{"tolerance", OPTION_REAL, AT(wanted.tolerance_px), .min = 1e-6, .max = 1e6},
	LENS_ROWS,
};

static int fisheye_check_options(void *context, struct fault *fault)
{
	struct fisheye_job *job = context;
	const char *const single[] = {job->live, job->circle, job->known};
	const bool with_board = job->lens.files || job->live;
	int sources = job->lens.files > 0, err;

	for (int k = 0; k < 3; k++)
		if (single[k] && ++sources == 1)
			job->lens.file[job->lens.files++] = (char *)single[k];
	if (sources != 1)
		return fault_say(fault, -EINVAL,
				 "expected one of --images, --live, --circle and --lens");
	job->lens.anew = job->known;
	err = lens_job_check_board(with_board, job->board, fault);
	if (err)
		return err;
	if (job->world && !with_board)
		return fault_say(fault, -EINVAL, "--world goes with --images or --live");
	if (job->rotation_given && (job->world || (!with_board && !job->circle)))
		return fault_say(
			fault, -EINVAL,
			"--rotation goes with --images, --live or --circle, without --world: else it is found");
	if (job->known && !job->uniform)
		return fault_say(fault, -EINVAL, "--lens goes with --uniform");
	if (job->known && job->lens.report)
		return fault_say(fault, -EINVAL, "--report: there is none of --uniform alone");
	return 0;
}

/* ---- work ---- */

struct fisheye_work {
	struct gathering all;
	struct fisheye_result result;
	struct falloff falloff;
	struct lens_ini known;
};

static int find_circle(const struct fisheye_job *job, struct fisheye_work *work,
		       struct fault *fault)
{
	const char *path = job->lens.file[0];
	struct image picture;
	int err = image_read(path, &picture, fault);

	if (!err)
		err = fisheye_circle(&work->result, &work->all.seen, &picture, path, job->rim_deg,
				     &job->wanted, fault);
	if (!err && gather_keep(&work->all, &picture))
		err = fault_say(fault, -ENOMEM, "%s: out of memory", path);
	image_free(&picture);
	return err;
}

static int find_points(struct fisheye_job *job, struct fisheye_work *work, struct fault *fault)
{
	struct board board;
	int err = board_parse(&board, job->board, fault);

	if (!err && job->live)
		err = gather_live(&work->all, job->live, LIVE_FISHEYE, &board, job->views,
				  job->world ? atoi(job->world) : 0, fault);
	else if (!err)
		err = gather_images(&work->all, job->lens.file, job->lens.files, &board, fault);
	if (!err && job->world) {
		job->wanted.world_view = lens_job_view("--world", job->world, &work->all, fault);
		err = job->wanted.world_view < 0 ? job->wanted.world_view : 0;
	}
	return err ? err : fisheye_find(&work->result, &work->all.seen, &job->wanted, fault);
}

static int find_lens(struct fisheye_job *job, struct fisheye_work *work, struct fault *fault)
{
	int err;

	if (job->circle)
		return find_circle(job, work, fault);
	if (!job->known)
		return find_points(job, work, fault);
	err = lens_read_ini(&work->known, job->lens.file[0], fault);
	if (err)
		return err;
	work->result.lens = work->known.fisheye;
	verdict_begin(&work->result.finding.verdict);
	return work->known.fisheye_given
		       ? 0
		       : fault_say(fault, -EINVAL, "%s: expected a section [fisheye]",
				   job->lens.file[0]);
}

/* Says how the lens is turned, or doubts a lens of which that is not known: it measures light from
 * the wrong directions, however well it was found. */
static void turn_lens(const struct fisheye_job *job, struct fisheye_result *result)
{
	if (job->rotation_given) {
		memcpy(result->lens.rotation_deg, job->rotation_deg, sizeof(job->rotation_deg));
		result->oriented = true;
	}
	if (!result->oriented)
		verdict_doubt(
			&result->finding.verdict,
			job->circle
				? "give --rotation 0,0,0 if it lies on its back with the picture's right towards world X, or what it is"
				: "name the photograph of a board that is level, its rows along world X, by --world, or give --rotation if it is known",
			"the lens is known, but not how it is turned towards the world: light would come from elsewhere");
}

static bool has_lens(const struct fisheye_job *job, const struct fisheye_work *work)
{
	return job->known || work->result.finding.estimate.count > 0;
}

static int find_falloff(const struct fisheye_job *job, struct fisheye_work *work,
			struct fault *fault)
{
	struct image picture;
	int err;

	if (!job->uniform || !has_lens(job, work))
		return 0;
	err = image_read(job->uniform, &picture, fault);
	if (err)
		return err;
	err = falloff_find(&work->falloff, &picture, &work->result.lens, fault);
	image_free(&picture);
	memcpy(work->result.lens.falloff, work->falloff.v, sizeof(work->falloff.v));
	return err;
}

/* Writes report and result. Returns 0; 1: not trusted; negative errno. */
static int fisheye_conclude(const struct fisheye_job *job, const struct fisheye_work *work,
			    struct fault *fault)
{
	const struct verdict *lens = &work->result.finding.verdict;
	const struct verdict *doubted = !lens->trusted || !job->uniform ? lens
									: &work->falloff.verdict;
	const struct fisheye_result *found = job->known ? NULL : &work->result;
	const struct falloff *falloff = job->uniform && has_lens(job, work) ? &work->falloff : NULL;
	int err = lens_job_report(&job->lens, &work->all, &work->result.finding, fault);

	if (found)
		fisheye_print(stdout, "", found);
	if (falloff)
		falloff_print(stdout, "", falloff);
	if (!err && has_lens(job, work) && (doubted->trusted || job->lens.force))
		err = fisheye_file_write(job->lens.output, &work->result.lens, found, falloff,
					 fault);
	return err ? err : verdict_end(doubted);
}

static int fisheye_calibrate(void *context, struct fault *fault)
{
	struct fisheye_job *job = context;
	struct fisheye_work *work = calloc(1, sizeof(*work));
	int err;

	if (!work)
		return fault_say(fault, -ENOMEM, "out of memory");
	err = find_lens(job, work, fault);
	if (!err && !job->known)
		turn_lens(job, &work->result);
	if (!err)
		err = find_falloff(job, work, fault);
	if (!err)
		err = fisheye_conclude(job, work, fault);
	fisheye_result_free(&work->result);
	gather_free(&work->all);
	free(work);
	return err;
}

static int fisheye_run(const struct command *command, int argc, char **argv)
{
	static const struct lens_calls calls = {rows, fisheye_check_options, fisheye_calibrate};
	struct fisheye_job job = {.wanted = {.model = FISHEYE_MODEL_AUTO,
					     .field_deg = 90,
					     .tolerance_px = 0.5,
					     .world_view = -1},
				  .rim_deg = 90,
				  .views = 8};

	return lens_job_run(command, argc, argv, &calls, &job.lens, &job);
}

const struct command fisheye_command = {
	.name = "fisheye",
	.usage = "((--images GLOB... | --live CONFIG) --board SPEC | --circle PICTURE |\n"
		 "        --lens EYE.ini) [options] -o EYE.ini",
	.summary = "the lens that looks at the sky",
	.help = "\n"
		"  --images GLOB        photographs of a board, in several places; more may follow\n"
		"  --live CONFIG        the fisheye of a kiosk's configuration, before which a board is moved\n"
		"  --views N            live: pictures of the board at most; 8\n"
		"  --board SPEC         9x6:25mm, charuco:8x6:30mm:22mm, as inlay-calibrate board names it\n"
		"  --world VIEW         where the board is level, its rows along world X (face down over a\n"
		"                       lens that looks up): a file, or its number among all photographs\n"
		"  --rotation X,Y,Z     how the lens is turned, where that is known, as [fisheye] rotation\n"
		"                       (degrees); 0,0,0: on its back, the picture's right towards world X\n"
		"  --circle PICTURE     a picture whose image circle is bright to its rim\n"
		"  --rim-deg DEG        the rim's angle from the axis; 90\n"
		"  --lens EYE.ini       a lens that is known, to add its falloff to\n"
		"  --uniform PICTURE    something equally bright all over: the lens's falloff\n"
		"  --model MODEL        equidistant, equisolid, stereographic, orthographic,\n"
		"                       polynomial; auto: what the points speak for\n"
		"  --field DEG          half the field of view that is used; 90\n"
		"  --tolerance PX       one standard deviation, anywhere in the circle; 0.5\n"
		"  --report DIR         pictures, maps and tables\n"
		"  --force              write also what cannot be trusted\n"
		"  -o, --output FILE    the lens, for [fisheye] lens of the configuration\n\n"
		"Exit 0: the result can be trusted, and is written. 1: it cannot, for the reason given.\n",
	.run = fisheye_run,
};
