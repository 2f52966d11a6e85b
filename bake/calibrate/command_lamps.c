/* SPDX-License-Identifier: MIT */
/* inlay-calibrate lamps: where lamps hang, by the fisheye laid on several places. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/commands.h"
#include "bake/calibrate/estimate/lens_ini.h"
#include "bake/calibrate/lamps/lamp_places.h"
#include "bake/calibrate/lens_job.h"
#include "hal/base/log.h"

#define FRAME_MS 5000
#define WORLD_MAX 1000 /* m, as in the configuration */

struct lamps_job {
	struct lens_job lens; /* its files are the pictures */
	const char *live, *known;
	struct option_list at;
	double place[SIGHT_PLACES_MAX][3];
	double px, place_m, turn_deg, tolerance_percent;
};

/* ---- options ---- */

static int read_picture(void *field, const char *option, const char *text, struct fault *fault)
{
	struct lens_job *lens = field;

	(void)option;
	(void)fault;
	lens->file[lens->files++] = (char *)text;
	return 0;
}

#define AT(field) .place = offsetof(struct lamps_job, field)

static const struct option_row rows[] = {
	{"at", OPTION_LIST, AT(at)},
	{"picture", OPTION_OTHER, AT(lens), .take = read_picture},
	{"lens", OPTION_TEXT, AT(known)},
	{"live", OPTION_TEXT, AT(live)},
	{"deviation", OPTION_REAL, AT(px), .min = 0.01, .max = 100},
	{"place-deviation", OPTION_REAL, AT(place_m), .min = 1e-6, .max = 1},
	{"turn-deviation", OPTION_REAL, AT(turn_deg), .min = 1e-6, .max = 30},
	{"tolerance", OPTION_REAL, AT(tolerance_percent), .min = 0.01, .max = 100},
	LENS_ROWS,
};

/* Places within three deviations of each other are one. */
static int check_places(const struct lamps_job *job, struct fault *fault)
{
	for (int k = 0; k < job->at.count; k++)
		for (int j = 0; j < k; j++) {
			double square = 0;

			for (int i = 0; i < 3; i++)
				square += (job->place[k][i] - job->place[j][i]) *
					  (job->place[k][i] - job->place[j][i]);
			if (square <= 9 * job->place_m * job->place_m)
				return fault_say(
					fault, -EINVAL,
					"--at %s: is where --at %s is, expected another place",
					job->at.text[k], job->at.text[j]);
		}
	return 0;
}

static int lamps_check_options(void *context, struct fault *fault)
{
	struct lamps_job *job = context;

	if (!job->live == !job->lens.files)
		return fault_say(fault, -EINVAL, "expected either --live or --picture");
	if (!job->live != !!job->known)
		return fault_say(
			fault, -EINVAL,
			job->live
				? "--lens: is that of the configuration, expected --picture with it"
				: "--lens is missing");
	if (job->at.count < 2 || job->at.count > SIGHT_PLACES_MAX)
		return fault_say(
			fault, -EINVAL,
			"--at: is given %d times, expected 2 to %d places: from one nobody can tell how far a lamp is",
			job->at.count, SIGHT_PLACES_MAX);
	if (!job->live && job->lens.files != job->at.count)
		return fault_say(fault, -EINVAL,
				 "--picture: is given %d times, expected one for each of %d --at",
				 job->lens.files, job->at.count);
	for (int k = 0; k < job->at.count; k++)
		if (option_reals("--at", job->at.text[k], 3, 3, -WORLD_MAX, WORLD_MAX,
				 job->place[k], fault) < 0)
			return -EINVAL;
	return check_places(job, fault);
}

/* ---- pictures ---- */

struct lamps_work {
	struct gathering all;
	struct lamp_places places;
	struct transfer_curve curve;
	char name[SIGHT_PLACES_MAX][32]; /* of live pictures */
};

/* Looks for lights in the next place's picture, which the report gets if it is of 8 bits. */
static int look_at(const struct lamps_job *job, struct lamps_work *work, const char *name,
		   struct image *picture, struct fault *fault)
{
	struct observations *seen = &work->all.seen;
	const int k = work->places.sights;
	struct lamp_sight *sight = &work->places.sight[k];

	if (k && (picture->width != seen->width || picture->height != seen->height))
		return fault_say(fault, -EINVAL, "%s: is of %dx%d pixels, expected %dx%d as before",
				 name, picture->width, picture->height, seen->width, seen->height);
	seen->width = picture->width;
	seen->height = picture->height;
	sight->name = name;
	memcpy(sight->at, job->place[k], sizeof(sight->at));
	if (lamp_sight_look(sight, picture, &work->curve, &work->places.lens) ||
	    (picture->u8 && work->all.pictures == k && gather_keep(&work->all, picture)))
		return fault_say(fault, -ENOMEM, "%s: out of memory", name);
	work->places.sights++;
	return 0;
}

static int look_at_file(const struct lamps_job *job, struct lamps_work *work,
			const struct fisheye_settings *lens, const char *path, struct fault *fault)
{
	struct image picture;
	int err = image_read(path, &picture, fault);

	if (!err)
		err = fisheye_prepare(&work->places.lens, lens, picture.width, picture.height,
				      fault);
	if (!err)
		err = look_at(job, work, path, &picture, fault);
	image_free(&picture);
	return err;
}

static int look_at_files(const struct lamps_job *job, struct lamps_work *work, struct fault *fault)
{
	struct lens_ini ini;
	int err = lens_read_ini(&ini, job->known, fault);

	if (!err && !ini.fisheye_given)
		err = fault_say(fault, -EINVAL, "%s: expected a section [fisheye]", job->known);
	for (int k = 0; !err && k < job->lens.files; k++)
		err = look_at_file(job, work, &ini.fisheye, job->lens.file[k], fault);
	return err;
}

/* Waits until the person says that the fisheye lies there. */
static int await_person(const char *at, struct fault *fault)
{
	int letter;

	log_info("lay the fisheye at %s, turned as before, go out of its sight, and press Enter",
		 at);
	do
		letter = getchar();
	while (letter != '\n' && letter != EOF);
	return letter == '\n'
		       ? 0
		       : fault_say(fault, -ECANCELED, "ended before the fisheye lay at %s", at);
}

static int look_live(const struct lamps_job *job, struct lamps_work *work, struct fault *fault)
{
	struct fisheye_settings lens;
	struct live *live;
	int err = live_open(&live, job->live, LIVE_FISHEYE, fault);

	if (!err)
		err = live_lens(live, &lens, &work->curve, fault);
	if (!err)
		err = fisheye_prepare(&work->places.lens, &lens, live_width(live),
				      live_height(live), fault);
	for (int k = 0; !err && k < job->at.count; k++) {
		struct image picture = {.width = 0};
		int64_t captured_ns;

		snprintf(work->name[k], sizeof(work->name[k]), "place %d", k + 1);
		err = await_person(job->at.text[k], fault);
		if (!err)
			err = live_flush(live, fault);
		if (!err)
			err = live_next(live, FRAME_MS, &picture, &captured_ns, fault);
		if (!err)
			err = look_at(job, work, work->name[k], &picture, fault);
		if (!err)
			log_info("%s shows %d light%s", work->name[k], work->places.sight[k].count,
				 work->places.sight[k].count == 1 ? "" : "s");
		if (!err)
			log_info("%s shows %d light%s", work->name[k], work->places.sight[k].count,
				 work->places.sight[k].count == 1 ? "" : "s");
		image_free(&picture);
	}
	live_close(live);
	return err;
}

/* ---- work ---- */

/* Writes report and result. Returns 0; 1: not trusted; negative errno. */
static int lamps_conclude(const struct lamps_job *job, const struct lamps_work *work,
			  struct fault *fault)
{
	const struct lamp_places *places = &work->places;
	const struct verdict *verdict = &places->finding.verdict;
	int err = 0;

	if (places->lamps.count)
		err = lens_job_report(&job->lens, &work->all, &places->finding, fault);
	finding_print(stdout, "", &places->finding);
	for (int k = 0; k < places->finding.estimate.count; k++)
		estimate_print(stdout, "", &places->finding.estimate, k);
	if (!err && places->lamps.count && (verdict->trusted || job->lens.force))
		err = lamp_places_write(places, job->lens.output, fault);
	return err ? err : verdict_end(verdict);
}

static int lamps_calibrate(void *context, struct fault *fault)
{
	const struct lamps_job *job = context;
	struct lamps_work *work = calloc(1, sizeof(*work));
	int err;

	if (!work)
		return fault_say(fault, -ENOMEM, "out of memory");
	work->places.deviation = (struct lamp_deviations){
		.px = job->px, .place_m = job->place_m, .turn = job->turn_deg * (M_PI / 180)};
	work->places.tolerance = job->tolerance_percent / 100;
	err = job->live ? look_live(job, work, fault) : look_at_files(job, work, fault);
	if (!err)
		err = lamp_places_find(&work->places, &work->all.seen, fault);
	if (!err)
		err = lamps_conclude(job, work, fault);
	lamp_places_free(&work->places);
	gather_free(&work->all);
	free(work);
	return err;
}

static int lamps_run(const struct command *command, int argc, char **argv)
{
	static const struct lens_calls calls = {rows, lamps_check_options, lamps_calibrate};
	/* inlay-calibrate fisheye trusts a lens up to half a pixel; a tape measure is right to a
	 * centimetre, an edge along which the fisheye is laid to half a degree. Five percent of the
	 * distance leave 3 % of the brightness 0.3 m beside a fisheye 1 m from the lamp. */
	struct lamps_job job = {
		.px = 0.5, .place_m = 0.01, .turn_deg = 0.5, .tolerance_percent = 5};

	return lens_job_run(command, argc, argv, &calls, &job.lens, &job);
}

const struct command lamps_command = {
	.name = "lamps",
	.usage = "(--live CONFIG | --lens EYE.ini --picture FILE...) --at X,Y,Z... [options]\n"
		 "        -o LAMPS.ini",
	.summary = "where lamps hang in the room",
	.help = "\n"
		"  --live CONFIG        the fisheye of a kiosk's configuration, which is laid on each place in turn\n"
		"  --lens EYE.ini       the fisheye of the pictures, with its rotation, which is the same in all\n"
		"  --picture FILE       one for each --at, in their order: 8-bit, or linear light\n"
		"  --at X,Y,Z           where the lens is, metres, world; two to four places, a metre or more\n"
		"                       apart\n"
		"  --deviation PX       one standard deviation of what lens and picture tell; 0.5\n"
		"  --place-deviation M  of each number of --at; 0.01\n"
		"  --turn-deviation DEG of how the fisheye is turned each time; 0.5\n"
		"  --tolerance PERCENT  one standard deviation of a lamp's place, of its distance; 5\n"
		"  --report DIR         pictures and tables\n"
		"  --force              write also what cannot be trusted\n"
		"  -o, --output FILE    sections [lamp NAME], to be added to the configuration\n\n"
		"Exit 0: the result can be trusted, and is written. 1: it cannot, for the reason given.\n",
	.run = lamps_run,
};
