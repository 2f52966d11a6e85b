/* SPDX-License-Identifier: MIT */
/* inlay-calibrate camera: where the background camera stands, and what its lens does. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/camera/camera.h"
#include "bake/calibrate/camera/camera_edges.h"
#include "bake/calibrate/camera/camera_parts.h"
#include "bake/calibrate/commands.h"
#include "bake/calibrate/estimate/lens_ini.h"
#include "bake/calibrate/lens_job.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/optics/vec.h"

/* Range of plausible distances between a kiosk's camera and what it looks at. */
#define NEAREST_M 0.02
#define FARTHEST_M 300
#define FARTHEST 1e12 /* in any unit */

/* Prints the same figures as lines that begin with before. */
static void camera_print(FILE *to, const char *before, const struct camera_solution *solution)
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

/* Writes section [camera] of the reference view, with deviations, figures and verdict as comments.
 * The file is replaced at once. -errno. */
static int camera_file_write(const char *path, const struct camera_solution *solution,
			     struct fault *fault)
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

static const char *const unit_names[] = {"m", "cm", "mm", "in", NULL};
static const double unit_mm[] = {1000, 10, 1, 25.4};

struct camera_job {
	struct lens_job lens;
	struct camera_task task;
	struct points_convention convention;
	char source; /* initial of --points, --images or --live */
	const char *board, *intrinsics, *reference;
	int views; /* 0: not given */
	int unit;  /* index into unit_names */
	struct lens_ini known;
	struct board shown; /* of --board, settled by the photographs */
};

/* ---- options ---- */

/* Reads a source; the words that follow are more of its files. */
static int read_source(void *field, const char *option, const char *text, struct fault *fault)
{
	struct camera_job *job = field;
	const char source = option[2];

	if (job->source && job->source != source)
		return fault_say(fault, -EINVAL, "expected one of --points, --images and --live");
	job->source = source;
	job->lens.more = source != 'l';
	job->lens.file[job->lens.files++] = (char *)text;
	return 0;
}

static int read_object(void *field, const char *option, const char *text, struct fault *fault)
{
	struct camera_task *task = field;
	double number[4] = {0};
	const int count = option_reals(option, text, 3, 4, -FARTHEST, FARTHEST, number, fault);

	if (count < 0)
		return count;
	if (number[3] < 0)
		return fault_say(fault, -EINVAL, "--object: a radius of %g, expected 0 or more",
				 number[3]);
	memcpy(task->object, number, sizeof(task->object));
	task->object_radius = number[3];
	return 0;
}

static int read_centre(void *field, const char *option, const char *text, struct fault *fault)
{
	const int count = option_reals(option, text, 2, 2, -FARTHEST, FARTHEST, field, fault);

	return count < 0 ? count : 0;
}

#define AT(field) .place = offsetof(struct camera_job, field)
#define GIVEN(field) .given = offsetof(struct camera_job, field)

static const struct option_row rows[] = {
	{"points", OPTION_OTHER, .take = read_source},
	{"images", OPTION_OTHER, .take = read_source},
	{"live", OPTION_OTHER, .take = read_source},
	{"board", OPTION_TEXT, AT(board)},
	{"views", OPTION_INT, AT(views), .min = 1, .max = 1000},
	{"size", OPTION_SIZE, AT(task.width)},
	{"centre", OPTION_OTHER, AT(task.centre_px), .take = read_centre, GIVEN(task.centre_given)},
	{"centre-deviation", OPTION_REAL, AT(task.centre_deviation_px), .max = FARTHEST},
	{"aspect", OPTION_REAL, AT(task.aspect), .min = 0.01, .max = 100, GIVEN(task.aspect_given)},
	{"aspect-deviation", OPTION_REAL, AT(task.aspect_deviation), .max = 1},
	{"y-up", OPTION_FLAG, AT(convention.y_up)},
	{"pixel-centre", OPTION_REAL, AT(convention.pixel_centre), .max = 0.5},
	{"distortion", OPTION_CHOICE, AT(task.distortion), .choices = tsai_distortion_names},
	{"radial", OPTION_INT, AT(task.radial), .min = 1, .max = 3},
	{"robust", OPTION_FLAG, AT(task.robust)},
	{"intrinsics", OPTION_TEXT, AT(intrinsics)},
	{"reference", OPTION_TEXT, AT(reference)},
	{"object", OPTION_OTHER, AT(task), .take = read_object, GIVEN(task.object_given)},
	{"tolerance", OPTION_REAL, AT(task.tolerance_px), .min = 1e-6, .max = 1e6},
	{"unit", OPTION_CHOICE, AT(unit), .choices = unit_names},
	{"z-down", OPTION_FLAG, AT(task.z_down)},
	LENS_ROWS,
};

static int camera_check_options(void *context, struct fault *fault)
{
	struct camera_job *job = context;
	int err;

	job->task.unit_mm = unit_mm[job->unit];
	if (!job->source)
		return fault_say(fault, -EINVAL, "expected --points, --images or --live");
	err = lens_job_check_board(job->source != 'p', job->board, fault);
	if (err)
		return err;
	if (job->views && job->source != 'l')
		return fault_say(fault, -EINVAL, "--views goes with --live");
	if (job->source == 'p' && !job->task.width && !job->intrinsics)
		return fault_say(fault, -EINVAL, "--size is missing");
	if (job->task.width && (job->source != 'p' || job->intrinsics))
		return fault_say(fault, -EINVAL, "--size: the %s how large the picture is",
				 job->intrinsics ? "file of --intrinsics says"
						 : "pictures themselves say");
	if (job->intrinsics && (job->task.centre_given || job->task.centre_deviation_px >= 0))
		return fault_say(
			fault, -EINVAL,
			"--centre and --centre-deviation: the file of --intrinsics says them");
	if (job->intrinsics && job->task.radial)
		return fault_say(fault, -EINVAL,
				 "--radial: the file of --intrinsics says the distortion");
	if (job->intrinsics && (job->task.aspect_given || job->task.aspect_deviation >= 0))
		return fault_say(
			fault, -EINVAL,
			"--aspect and --aspect-deviation: the file of --intrinsics says them");
	return 0;
}

/* ---- work ---- */

static int read_intrinsics(struct camera_job *job, struct fault *fault)
{
	struct fault why = {.text = ""};
	int err;

	if (!job->intrinsics)
		return 0;
	err = lens_read_ini(&job->known, job->intrinsics, fault);
	if (err)
		return err;
	if (!job->known.camera_given)
		return fault_say(fault, -EINVAL, "%s: expected a section [camera]",
				 job->intrinsics);
	if (tsai_check(&job->known.camera, &why))
		return fault_say(fault, -EINVAL, "%s: %s", job->intrinsics, why.text);
	job->task.intrinsics = &job->known.camera;
	job->task.width = job->known.camera.width;
	job->task.height = job->known.camera.height;
	return 0;
}

static int camera_gather(struct camera_job *job, struct gathering *all, struct fault *fault)
{
	int err = 0;

	if (job->board) {
		err = board_parse(&job->shown, job->board, fault);
		job->shown.unit = 1 / job->task.unit_mm;
	}
	if (err)
		return err;
	job->convention.height = job->task.height;
	if (job->source == 'p')
		return gather_points(all, job->lens.file, job->lens.files, &job->convention, fault);
	if (job->source == 'i')
		err = gather_images(all, job->lens.file, job->lens.files, &job->shown, fault);
	else
		err = gather_live(all, job->lens.file[0], LIVE_BACKGROUND, &job->shown,
				  job->views ? job->views : 1, atoi(job->reference), fault);
	if (err)
		return err;
	if (job->intrinsics &&
	    (all->seen.width != job->task.width || all->seen.height != job->task.height))
		return fault_say(fault, -EINVAL,
				 "%s is of pictures of %d x %d, these are of %d x %d",
				 job->intrinsics, job->task.width, job->task.height,
				 all->seen.width, all->seen.height);
	job->task.width = all->seen.width;
	job->task.height = all->seen.height;
	return 0;
}

/* Converts --centre, which is counted as the points are. */
static void place_centre(struct camera_job *job)
{
	double *centre = job->task.centre_px;

	for (int k = 0; k < 2; k++)
		centre[k] += 0.5 - job->convention.pixel_centre;
	if (job->convention.y_up)
		centre[1] = job->task.height - centre[1];
}

/* Warns of an implausible distance: the fit cannot tell mm from m. */
static void warn_of_unit(const struct camera_job *job, const struct camera_solution *solution)
{
	const double metres = vec_length(solution->camera.translation) * job->task.unit_mm / 1000;

	if (solution->finding.verdict.trusted && !(metres > NEAREST_M && metres < FARTHEST_M))
		log_warning("the world's origin is %.3g m from the camera: is --unit right?",
			    metres);
}

/* Finds the edge spread where there are photographs of corners; else it stays what --intrinsics
 * says. -ENOMEM. */
static int camera_find_edges(const struct camera_job *job, const struct gathering *all,
			     struct camera_solution *solution)
{
	struct camera_edges edges = {.count = 0};
	int err = 0;

	if (!solution->solved)
		return 0;
	if (job->intrinsics)
		solution->camera.edge_spread_px = job->known.camera.edge_spread_px;
	if (all->picture)
		err = camera_edges_measure(&all->seen, all->picture, &job->shown, &edges);
	if (err || !edges.count)
		return err;
	solution->camera.edge_spread_px = edges.sigma_px;
	finding_add(&solution->finding, "edge_spread_px", "edge spread, sigma", "px",
		    edges.sigma_px);
	finding_add(&solution->finding, "edge_spread_deviation_px",
		    "edge spread, one standard deviation", "px", edges.deviation_px);
	return 0;
}

/* Writes report and result. Returns 0; 1: not trusted; negative errno. */
static int camera_conclude(const struct camera_job *job, const struct gathering *all,
			   const struct camera_solution *solution, struct fault *fault)
{
	const bool trusted = solution->finding.verdict.trusted;
	int err = lens_job_report(&job->lens, all, &solution->finding, fault);

	camera_print(stdout, "", solution);
	warn_of_unit(job, solution);
	if (!err && solution->solved && (trusted || job->lens.force))
		err = camera_file_write(job->lens.output, solution, fault);
	return err ? err : verdict_end(&solution->finding.verdict);
}

static int camera_work(void *context, struct fault *fault)
{
	struct camera_job *job = context;
	struct gathering all = {.picture = NULL};
	struct camera_solution solution = {.solved = false};
	int err = read_intrinsics(job, fault);

	if (!err)
		err = camera_gather(job, &all, fault);
	if (!err && job->task.centre_given)
		place_centre(job);
	if (!err) {
		job->task.reference = lens_job_view("--reference", job->reference, &all, fault);
		err = job->task.reference < 0 ? job->task.reference : 0;
	}
	if (!err)
		err = camera_calibrate(&all.seen, &job->task, &solution, fault);
	if (!err)
		err = camera_find_edges(job, &all, &solution);
	if (!err)
		err = camera_conclude(job, &all, &solution, fault);
	camera_solution_free(&solution);
	gather_free(&all);
	return err;
}

static int camera_run(const struct command *command, int argc, char **argv)
{
	static const struct lens_calls calls = {rows, camera_check_options, camera_work};
	struct camera_job job = {.task = camera_task_default(),
				 .reference = "1",
				 .convention = {.pixel_centre = 0.5}};

	return lens_job_run(command, argc, argv, &calls, &job.lens, &job);
}

const struct command camera_command = {
	.name = "camera",
	.usage = "(--points FILE ... | --images 'GLOB' ... --board BOARD |\n"
		 "        --live CONFIG --board BOARD [--views N]) [options] -o CAM.ini",
	.summary = "where the background camera stands, and what its lens does",
	.help = "\n  --points F ...     files of lines xw yw zw xf yf, each a view\n"
		"  --images 'G' ...   photographs of a board\n"
		"  --live CONFIG      the background camera of a kiosk's configuration\n"
		"  --board BOARD      9x6:25mm, charuco:8x6:30mm:22mm, as inlay-calibrate board names it\n"
		"  --views N          live: pictures of the board at most (1); the screen says where\n"
		"  --size WxH         of the picture the points are in\n"
		"  --y-up             their y counts upwards from the lower edge\n"
		"  --pixel-centre P   where they have a pixel's centre: 0.5 (default) or 0\n"
		"  --centre X,Y       first guess of the axis, counted as the points (the middle)\n"
		"  --centre-deviation PX  of that, one standard deviation; 0: it is exact (2.5 % of\n"
		"                     the picture's diagonal)\n"
		"  --aspect S         s is known: 1 where pixels are square; else found, or held at 1\n"
		"                     where the points do not tell it\n"
		"  --aspect-deviation D  of an s that is held, one standard deviation (0.002; with\n"
		"                     --aspect 0: it is exact)\n"
		"  --distortion D     distorts (the thesis's, default) or undistorts (Tsai's)\n"
		"  --radial N         terms of its polynomial, 1 to 3: kappa1, kappa2, kappa3 (as many\n"
		"                     as predict best what was left out)\n"
		"  --robust           points that do not fit the others count less, and are named\n"
		"  --intrinsics F     the lens is known from this CAM.ini: the pose alone\n"
		"  --reference VIEW   photograph, or its number, whose board is the world (1): one without\n"
		"                     the board is refused\n"
		"  --object X,Y,Z[,R] where the object stands, and its radius (the points' box)\n"
		"  --tolerance PX     how uncertain its place in the picture may be (1)\n"
		"  --unit U           of the world: m (default), cm, mm, in\n"
		"  --z-down           the board's Z points away from the camera\n"
		"  --report DIR       a page that shows how well it fits\n"
		"  --force            write CAM.ini whatever the verdict\n"
		"  -o, --output FILE  the camera\n\n"
		"Exit 0: the result can be trusted, and is written. 1: it cannot, for the reason given.\n",
	.run = camera_run,
};
