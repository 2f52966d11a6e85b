/* SPDX-License-Identifier: MIT */
/* inlay-calibrate camera: where the background camera stands, and what its lens does. */
#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/camera/camera.h"
#include "bake/calibrate/camera/camera_edges.h"
#include "bake/calibrate/camera/camera_file.h"
#include "bake/calibrate/commands.h"
#include "bake/calibrate/estimate/lens_ini.h"
#include "bake/calibrate/lens_job.h"
#include "hal/base/log.h"
#include "hal/optics/vec.h"

/* Range of plausible distances between a kiosk's camera and what it looks at. */
#define NEAREST_M 0.02
#define FARTHEST_M 300
#define FARTHEST 1e12 /* in any unit */

enum {
	POINTS = 1,
	IMAGES,
	LIVE,
	BOARD,
	VIEWS,
	SIZE,
	CENTRE,
	CENTRE_DEVIATION,
	ASPECT,
	ASPECT_DEVIATION,
	Y_UP,
	PIXEL_CENTRE,
	DISTORTION,
	RADIAL,
	ROBUST,
	INTRINSICS,
	REFERENCE,
	OBJECT,
	TOLERANCE,
	UNIT,
	Z_DOWN
};

static const struct option options[] = {
	{"points", required_argument, NULL, POINTS},
	{"images", required_argument, NULL, IMAGES},
	{"live", required_argument, NULL, LIVE},
	{"board", required_argument, NULL, BOARD},
	{"views", required_argument, NULL, VIEWS},
	{"size", required_argument, NULL, SIZE},
	{"centre", required_argument, NULL, CENTRE},
	{"centre-deviation", required_argument, NULL, CENTRE_DEVIATION},
	{"aspect", required_argument, NULL, ASPECT},
	{"aspect-deviation", required_argument, NULL, ASPECT_DEVIATION},
	{"y-up", no_argument, NULL, Y_UP},
	{"pixel-centre", required_argument, NULL, PIXEL_CENTRE},
	{"distortion", required_argument, NULL, DISTORTION},
	{"radial", required_argument, NULL, RADIAL},
	{"robust", no_argument, NULL, ROBUST},
	{"intrinsics", required_argument, NULL, INTRINSICS},
	{"reference", required_argument, NULL, REFERENCE},
	{"object", required_argument, NULL, OBJECT},
	{"tolerance", required_argument, NULL, TOLERANCE},
	{"unit", required_argument, NULL, UNIT},
	{"z-down", no_argument, NULL, Z_DOWN},
	OPTIONS_OF_LENS,
};

static const char *const unit_names[] = {"m", "cm", "mm", "in", NULL};
static const double unit_mm[] = {1000, 10, 1, 25.4};

struct camera_job {
	struct lens_job lens;
	struct camera_task task;
	struct points_convention convention;
	int source; /* POINTS, IMAGES or LIVE */
	const char *board, *intrinsics, *reference;
	int views; /* 0: not given */
	struct lens_ini known;
	struct board shown; /* of --board, settled by the photographs */
};

/* ---- options ---- */

/* Reads a source; the words that follow are more of its files. */
static int read_source(struct camera_job *job, int option, struct fault *fault)
{
	if (job->source && job->source != option)
		return fault_say(fault, -EINVAL, "expected one of --points, --images and --live");
	job->source = option;
	job->lens.more = option != LIVE;
	job->lens.file[job->lens.files++] = optarg;
	return 0;
}

static int read_object(struct camera_job *job, struct fault *fault)
{
	double number[4] = {0};
	const int count = option_reals("--object", optarg, 3, 4, -FARTHEST, FARTHEST, number,
				       fault);

	if (count < 0)
		return count;
	if (number[3] < 0)
		return fault_say(fault, -EINVAL, "--object: a radius of %g, expected 0 or more",
				 number[3]);
	job->task.object_given = true;
	memcpy(job->task.object, number, sizeof(job->task.object));
	job->task.object_radius = number[3];
	return 0;
}

static int read_lens_option(struct camera_job *job, int option, struct fault *fault)
{
	struct camera_task *task = &job->task;
	int err;

	switch (option) {
	case SIZE:
		return option_size("--size", optarg, &task->width, &task->height, fault);
	case CENTRE:
		task->centre_given = true;
		err = option_reals("--centre", optarg, 2, 2, -FARTHEST, FARTHEST, task->centre_px,
				   fault);
		return err < 0 ? err : 0;
	case CENTRE_DEVIATION:
		return option_real("--centre-deviation", optarg, 0, FARTHEST,
				   &task->centre_deviation_px, fault);
	case ASPECT:
		task->aspect_given = true;
		return option_real("--aspect", optarg, 0.01, 100, &task->aspect, fault);
	case ASPECT_DEVIATION:
		return option_real("--aspect-deviation", optarg, 0, 1, &task->aspect_deviation,
				   fault);
	case Y_UP:
		job->convention.y_up = 1;
		return 0;
	case PIXEL_CENTRE:
		return option_real("--pixel-centre", optarg, 0, 0.5, &job->convention.pixel_centre,
				   fault);
	case DISTORTION:
		return option_choice("--distortion", optarg, tsai_distortion_names,
				     &task->distortion, fault);
	case RADIAL:
		return option_int("--radial", optarg, 1, 3, &task->radial, fault);
	default:
		job->intrinsics = optarg;
		return 0;
	}
}

static int camera_read_option(void *context, int option, struct fault *fault)
{
	struct camera_job *job = context;
	int unit = 0, err;

	switch (option) {
	case POINTS:
	case IMAGES:
	case LIVE:
		return read_source(job, option, fault);
	case BOARD:
		job->board = optarg;
		return 0;
	case VIEWS:
		return option_int("--views", optarg, 1, 1000, &job->views, fault);
	case ROBUST:
		job->task.robust = true;
		return 0;
	case REFERENCE:
		job->reference = optarg;
		return 0;
	case OBJECT:
		return read_object(job, fault);
	case TOLERANCE:
		return option_real("--tolerance", optarg, 1e-6, 1e6, &job->task.tolerance_px,
				   fault);
	case UNIT:
		err = option_choice("--unit", optarg, unit_names, &unit, fault);
		job->task.unit_mm = unit_mm[unit];
		return err;
	case Z_DOWN:
		job->task.z_down = true;
		return 0;
	default:
		return read_lens_option(job, option, fault);
	}
}

static int camera_check_options(void *context, struct fault *fault)
{
	const struct camera_job *job = context;
	int err;

	if (!job->source)
		return fault_say(fault, -EINVAL, "expected --points, --images or --live");
	err = lens_job_check_board(job->source != POINTS, job->board, fault);
	if (err)
		return err;
	if (job->views && job->source != LIVE)
		return fault_say(fault, -EINVAL, "--views goes with --live");
	if (job->source == POINTS && !job->task.width && !job->intrinsics)
		return fault_say(fault, -EINVAL, "--size is missing");
	if (job->task.width && (job->source != POINTS || job->intrinsics))
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
	if (job->source == POINTS)
		return gather_points(all, job->lens.file, job->lens.files, &job->convention, fault);
	if (job->source == IMAGES)
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
	static const struct lens_calls calls = {options, camera_read_option, camera_check_options,
						camera_work, NULL};
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
		"  --board BOARD      9x6:25mm, charuco:8x6:30mm:22mm (its\n"
		"                     markers and layout are found, or named as by inlay-calibrate\n"
		"                     board)\n"
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
