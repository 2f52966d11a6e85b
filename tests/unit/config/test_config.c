/* SPDX-License-Identifier: MIT */
/* The configuration: defaults, drivers' own keys, checks that concern several keys, printing. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/settings.h"
#include "config/config.h"
#include "hal/compositor/compositor.h"
#include "hal/lights/sampler.h"
#include "tests/support/test.h"

struct fake_options {
	double noise;
	char file[INI_PATH_MAX];
};

static const struct ini_key fake_keys[] = {{.name = "noise",
					    .type = INI_REAL,
					    .offset = offsetof(struct fake_options, noise),
					    .min = 0,
					    .max = 1,
					    .fallback = "0.25",
					    .help = "grain"},
					   {.name = "file",
					    .type = INI_PATH,
					    .offset = offsetof(struct fake_options, file),
					    .fallback = "",
					    .help = "a file"},
					   INI_KEYS_END};

static const struct config_driver fake_cameras[] = {
	{"plain", NULL, 0}, {"fake", fake_keys, sizeof(struct fake_options)}, {NULL, NULL, 0}};
static const struct config_driver fake_displays[] = {
	{"kms", fake_keys, sizeof(struct fake_options)}, {NULL, NULL, 0}};
static const struct config_driver fake_buttons[] = {
	{"fake", fake_keys, sizeof(struct fake_options)}, {NULL, NULL, 0}};
static const struct config_drivers fakes = {.list = {[CONFIG_CAMERA] = fake_cameras,
						     [CONFIG_DISPLAY] = fake_displays,
						     [CONFIG_BUTTONS] = fake_buttons}};

struct said {
	int count;
	char text[20][FAULT_TEXT_MAX];
};

static void note(void *context, const char *text)
{
	struct said *said = context;

	assert_true(said->count < 20);
	snprintf(said->text[said->count++], FAULT_TEXT_MAX, "%s", text);
}

static struct config *fresh(const struct config_drivers *drivers)
{
	struct config *config = NULL;

	assert_int_equal(config_create(&config, drivers), 0);
	return config;
}

static struct config *read_text(const char *text)
{
	struct config *config = fresh(&fakes);
	struct ini_report report = {.count = 0};
	int err = config_read_memory(config, text, strlen(text), "k.conf", &report);

	if (err)
		fail_msg("%s", report.first.text);
	return config;
}

TEST("defaults are those of the keys")
{
	struct config *c = fresh(&fakes);

	assert_string_equal(c->basis.file, "");
	assert_int_equal(c->camera_count, 0);
	assert_string_equal(c->fisheye.view.camera, "fisheye");
	assert_string_equal(c->background.view.camera, "background");
	assert_string_equal(c->scene.view.camera, "");
	assert_true(c->fisheye.view.view.squash == 1);
	assert_true(c->fisheye.lens.field_deg == 90);
	assert_int_equal(c->fisheye.transfer, TRANSFER_SRGB);
	assert_true(c->fisheye.gain == 1);
	assert_int_equal(c->lights.threshold_mode, THRESHOLD_AMBIENT);
	assert_true(c->lights.threshold.value == 0);
	assert_true(c->composite.gain == 1);
	assert_string_equal(c->screen->driver, "kms");
	assert_int_equal(c->screen->show, SHOW_COMPOSITE);
	assert_string_equal(c->buttons->driver, "none");
	assert_true(
		((struct fake_options *)config_options(c, CONFIG_DISPLAY, c->screen, 0))->noise ==
		0.25);
	config_destroy(c);
}

TEST("drivers keys reach their own options")
{
	struct config *c = read_text(
		"[camera sky]\ndriver = fake\nfake.noise = 0.5\nwidth = 320\n"
		"matrix = bt709\nformat = YUYV\n"
		"[camera b]\n[screen]\nkms.noise = 1\n[buttons]\nfake.noise = 0\n");
	struct config_camera *sky = config_camera_named(c, "sky");
	struct fake_options *options;

	assert_int_equal(c->camera_count, 2);
	assert_non_null(sky);
	assert_int_equal(sky->settings.width, 320);
	assert_int_equal(sky->settings.matrix, MATRIX_BT709 + 1);
	assert_int_equal(sky->settings.range, 0);
	assert_int_equal(sky->settings.format, PIXEL_YUYV);
	assert_int_equal(sky->settings.buffers, 4);
	options = config_options(c, CONFIG_CAMERA, sky,
				 config_driver_index(c, CONFIG_CAMERA, "fake"));
	assert_true(options->noise == 0.5);
	options = config_options(c, CONFIG_CAMERA, config_camera_named(c, "b"), 1);
	assert_true(options->noise == 0.25);
	options = config_options(c, CONFIG_DISPLAY, c->screen, 0);
	assert_true(options->noise == 1);
	options = config_options(c, CONFIG_BUTTONS, c->buttons, 0);
	assert_true(options->noise == 0);
	assert_int_equal(config_driver_index(c, CONFIG_CAMERA, "none"), -1);
	config_destroy(c);
}

/* A program that opens no device reads the rest, and faults there are still said. */
TEST("without drivers their sections are skipped")
{
	static const char text[] =
		"[camera sky]\ndriver = fake\nfake.noise = 0.5\n[screen]\nx.y = 1\n"
		"[composite]\ngain = 2\n[camera b]\n[background]\ntransfer = bt709\n";
	static const char wrong[] = "[screen]\nx.y = 1\n[background]\ntransfr = bt709\n";
	struct ini_report report = {.count = 0};
	struct config *c = fresh(NULL);

	assert_true(c->composite.gain == 1);
	assert_int_equal(config_read_memory(c, text, strlen(text), "k.conf", &report), 0);
	assert_true(c->composite.gain == 2);
	assert_int_equal(c->background.transfer, TRANSFER_BT709);
	assert_int_equal(c->camera_count, 0);
	config_destroy(c);
	c = fresh(NULL);
	assert_int_equal(config_read_memory(c, wrong, strlen(wrong), "k.conf", &report), -EINVAL);
	assert_int_equal(report.count, 1);
	assert_string_equal(
		report.first.text,
		"k.conf:4: [background] transfr: unknown key, did you mean \"transfer\"?");
	config_destroy(c);
}

TEST("one camera too many is said")
{
	static const char text[] = "[camera a]\n[camera b]\n[camera c]\n[camera d]\n[camera e]\n";
	struct config *c = fresh(&fakes);
	struct ini_report report = {.count = 0};

	assert_int_equal(config_read_memory(c, text, strlen(text), "k.conf", &report), -EINVAL);
	assert_string_equal(
		report.first.text,
		"k.conf:5: [camera e] is one section [camera NAME] more than there is room for");
	config_destroy(c);
}

TEST("what no key tells alone")
{
	static const char text[] = "[camera sky]\ndriver = fak\n[camera bg]\ndriver = fake\n"
				   "fake.file = missing.hdr\n[camera many]\ndriver = fake\n"
				   "fake.file = many%03d.png\n[fisheye]\ncamera = skyy\n"
				   "[background]\ncamera =\n[screen]\ndriver = kns\nshow = scene\n"
				   "[buttons]\ndriver = gpio\n";
	static const char *const expected[] = {
		"k.conf: [basis] file: is empty, expected the basis file that inlay-bake made",
		"k.conf: [camera sky] driver: is \"fak\", expected one of plain, fake; did you mean \"fake\"?",
		"k.conf: [camera bg] fake.file: cannot read \"missing.hdr\": No such file or directory",
		"k.conf: [fisheye] camera: there is no section [camera skyy]; did you mean \"sky\"?",
		"k.conf: [background] camera: is empty, expected the name of a [camera NAME]",
		"k.conf: [screen] show: is scene, but [scene] camera is empty; expected the name of a [camera NAME] there",
		"k.conf: [screen] driver: is \"kns\", expected one of kms; did you mean \"kms\"?",
		"k.conf: [buttons] driver: is \"gpio\", expected one of none, fake",
	};
	struct config *c = read_text(text);
	struct said said = {.count = 0};
	struct ini_report report = {.say = note, .context = &said};

	assert_int_equal(config_check(c, &report), -EINVAL);
	assert_int_equal(said.count, sizeof(expected) / sizeof(*expected));
	for (int i = 0; i < said.count; i++)
		assert_string_equal(said.text[i], expected[i]);
	config_destroy(c);
	c = read_text("[basis]\nfile = x.inlay\n[camera fisheye]\ndriver = fake\n"
		      "[camera background]\ndriver=plain\n");
	assert_int_equal(config_check(c, &report), 0);
	config_destroy(c);
}

TEST("the camera of depth measures depths")
{
	struct config *c = read_text("[basis]\nfile = x.inlay\n[camera fisheye]\ndriver = fake\n"
				     "[camera background]\ndriver = plain\n"
				     "[camera far]\ndriver = plain\nbuffers = 2\nwidth = 424\n"
				     "[depth]\ncamera = far\nhflip = yes\nunit = 0.1\n");
	struct ini_report report = {.count = 0};
	const struct camera_settings far = config_camera_settings(c, config_camera_named(c, "far"));
	const struct camera_settings other =
		config_camera_settings(c, config_camera_named(c, "background"));

	assert_int_equal(config_check(c, &report), 0);
	assert_true(c->depth.view.view.hflip);
	assert_true(c->depth.unit_mm == 0.1);
	assert_int_equal(far.format, PIXEL_Z16);
	assert_int_equal(far.width, 424);
	assert_int_equal(far.buffers, 3); /* one is read, two are the driver's */
	assert_int_equal(other.format, PIXEL_NONE);
	assert_int_equal(other.buffers, 4);
	config_destroy(c);
}

TEST("lamps of the room")
{
	struct config *c = read_text("[lamp desk]\nposition = 1, -0.5, 1.25\nradius = 0.04\n"
				     "[lamp door]\nposition = -2 0 2.1\nradius = 0.1\n"
				     "[fisheye]\nposition = 0.3 0 0.15\n");

	assert_int_equal(c->lamps.count, 2);
	assert_string_equal(c->lamp_name[1], "door");
	assert_true(c->lamps.lamp[0].position[1] == -0.5 && c->lamps.lamp[0].radius == 0.04);
	assert_true(c->lamps.lamp[1].position[2] == 2.1 && c->lamps.fisheye[2] == 0.15);
	config_destroy(c);
}

TEST("what is wrong with lamps")
{
	static const struct {
		const char *text, *why;
	} cases[] = {
		{"[lamp a]\nradius = 0.1\n", "k.conf:1: [lamp a] position: is missing"},
		{"[lamp a]\nposition = 0 0 2\nradius = 0\n",
		 "k.conf:3: [lamp a] radius: is \"0\", expected a number 0.001..50 m"},
		{"[lamp a]\nposition = 0 2\n",
		 "k.conf:2: [lamp a] position: is \"0 2\", expected 3"},
		{"[lamp]\n", "k.conf:1: [lamp] has no name, expected [lamp NAME]"},
		{"[lamp a]\nposition = 0 0 2\nradius = 2\n",
		 "k.conf: [lamp a] position: is 0 0 2, 2 m from the fisheye's; expected more than its radius of 2 m"},
		{"[fisheye]\nposition = 0 0 1\n[lamp a]\nposition = 0 3 0.5\nradius = 0.1\n",
		 "k.conf: [lamp a] position: is 0 3 0.5, expected Z above the fisheye's 1 m"},
	};
	static const char others[] =
		"[basis]\nfile = x\n[camera fisheye]\ndriver = fake\n[camera background]\ndriver = plain\n";
	char many[LAMPS_MAX * 64 + 64] = "";

	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct config *c = fresh(&fakes);
		struct ini_report report = {.count = 0};

		assert_int_equal(config_read_memory(c, others, strlen(others), "o.conf", NULL), 0);
		if (config_read_memory(c, cases[i].text, strlen(cases[i].text), "k.conf",
				       &report) == 0)
			assert_int_equal(config_check(c, &report), -EINVAL);
		if (!strstr(report.first.text, cases[i].why))
			fail_msg("expected \"%s\", got \"%s\"", cases[i].why, report.first.text);
		config_destroy(c);
	}
	for (int i = 0; i <= LAMPS_MAX; i++)
		snprintf(many + strlen(many), 64, "[lamp l%d]\nposition = 0 0 2\nradius = 1\n", i);
	{
		struct config *c = fresh(&fakes);
		struct ini_report report = {.count = 0};

		assert_int_equal(config_read_memory(c, many, strlen(many), "k.conf", &report),
				 -EINVAL);
		assert_non_null(
			strstr(report.first.text,
			       "[lamp l8] is one section [lamp NAME] more than there is room for"));
		config_destroy(c);
	}
}

static char *printed(const struct config *config, void (*print)(const struct config *, FILE *))
{
	char *text = NULL;
	size_t bytes;
	FILE *stream = open_memstream(&text, &bytes);

	assert_non_null(stream);
	print(config, stream);
	fclose(stream);
	return text;
}

TEST("printing reads back")
{
	struct config *c = read_text(
		"[basis]\nfile = /a b.inlay\npose = 3\n[camera one]\nfake.noise = 0.1\n"
		"[camera two]\nrate = 29.97\n[fisheye]\nfocal = 74.8 66.845\nhflip = yes\n"
		"[lights]\nthreshold = 33.5%\nfollow = 0.25\nthreshold_mode = drop\n[screen]\n"
		"scale = fit\nshow = quad\n[lamp a]\nposition = 1 2 3\nradius = 0.5\n");
	char *text = printed(c, config_print), *again;
	struct config *other = read_text(text);

	assert_non_null(strstr(text, "[camera two]\n"));
	assert_non_null(strstr(text, "rate = 29.97\n"));
	assert_non_null(strstr(text, "focal = 74.8 66.845\n"));
	assert_int_equal(other->camera_count, 2);
	assert_true(other->lights.threshold.value == 33.5 && other->lights.threshold.percent);
	assert_true(other->lights.follow_s == 0.25);
	assert_int_equal(other->screen->show, SHOW_QUAD);
	assert_int_equal(other->lamps.count, 1);
	again = printed(other, config_print);
	assert_string_equal(text, again);
	free(text);
	free(again);
	config_destroy(c);
	config_destroy(other);
}

static char *file_text(const char *path)
{
	FILE *f = fopen(path, "r");
	char *text = calloc(1, 1 << 18);

	assert_non_null(text);
	if (!f)
		fail_msg("cannot open %s", path);
	assert_true(fread(text, 1, (1 << 18) - 1, f) > 0);
	fclose(f);
	return text;
}

static void write_file(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	assert_true(fputs(text, file) >= 0);
	assert_int_equal(fclose(file), 0);
}

TEST("what is written replaces nothing else")
{
	char path[] = "/tmp/inlay-basis-XXXXXX", text[512];
	const int fd = mkstemp(path);
	struct said said = {.count = 0};
	struct ini_report report = {.say = note, .context = &said};
	struct config *c;

	assert_true(fd >= 0);
	close(fd);
	snprintf(text, sizeof(text),
		 "[basis]\nfile = %s\n[camera fisheye]\ndriver = fake\n[camera background]\n"
		 "driver = plain\n[state]\nfile = %s\n[metrics]\nfile = /dev/null\n",
		 path, path);
	c = read_text(text);
	assert_int_equal(config_check(c, &report), -EINVAL);
	assert_int_equal(said.count, 2);
	assert_non_null(
		strstr(said.text[0], "[metrics] file: \"/dev/null\" is a folder, pipe or device"));
	assert_non_null(strstr(said.text[1], "[state] file: "));
	assert_non_null(strstr(said.text[1], "which is read; expected a file of its own"));
	config_destroy(c);
	unlink(path);
}

/* The results of a calibration replace what the configuration says of the lens. */
TEST("a lens of its own file")
{
	char path[] = "/tmp/inlay-lens-XXXXXX", text[256];
	const int fd = mkstemp(path);
	struct ini_report report = {.count = 0};
	struct config *c;

	assert_true(fd >= 0);
	close(fd);
	write_file(path, "[fisheye]\nfocal = 151 140\nmodel = equisolid\n");
	snprintf(text, sizeof(text), "[fisheye]\nlens = %s\nfocal = 9 9\nfield = 80\n", path);
	c = read_text(text);
	assert_int_equal(config_read_files(c, &report), 0);
	assert_true(c->fisheye.lens.focal_px[0] == 151 && c->fisheye.lens.focal_px[1] == 140);
	assert_true(c->fisheye.lens.field_deg == 80);
	assert_int_equal(c->fisheye.lens.model, FISHEYE_EQUISOLID);
	write_file(path, "[fisheye]\nfocal = 151 140\nmodle = equisolid\n");
	assert_int_equal(config_read_files(c, &report), -EINVAL);
	assert_non_null(strstr(report.first.text, path));
	assert_non_null(strstr(report.first.text, ":3: "));
	report = (struct ini_report){.count = 0};
	write_file(path, "; nothing\n");
	assert_int_equal(config_read_files(c, &report), -EINVAL);
	assert_non_null(strstr(report.first.text, "expected a [fisheye] section"));
	unlink(path);
	report = (struct ini_report){.count = 0};
	assert_int_equal(config_read_files(c, &report), -ENOENT);
	assert_non_null(strstr(report.first.text, "[fisheye] lens: cannot read"));
	report = (struct ini_report){.count = 0};
	assert_int_equal(mkdir(path, 0700), 0);
	assert_int_equal(config_read_files(c, &report), -EISDIR);
	assert_non_null(strstr(report.first.text, "[fisheye] lens: cannot read"));
	rmdir(path);
	config_destroy(c);
}

/* Every key is in the sample, at its default, with help and range as the tables say. */
TEST("sample file is what the tables say")
{
	struct config *c = fresh(driver_list());
	char *now = printed(c, config_write_sample);
	char *file = file_text("config/kiosk.conf");

#if WITH_KMS && WITH_SDL && WITH_GPIO
	assert_string_equal(file, now);
#else
	print_message("a driver was left out of this build: its keys in the sample go unchecked\n");
#endif
	free(file);
	free(now);
	config_destroy(c);
}

/* As many drivers as there is room for, and one more. */
TEST("too many drivers are refused")
{
	static const struct camera_ops camera = {.name = "one"};
	static const struct display_ops *const no_displays[] = {NULL};
	static const struct buttons_ops *const no_buttons[] = {NULL};
	const struct camera_ops *cameras[CONFIG_DRIVERS_MAX + 2] = {NULL};
	struct config_driver_room room;
	struct config_drivers drivers;
	struct config *c;

	for (int i = 0; i < CONFIG_DRIVERS_MAX; i++)
		cameras[i] = &camera;
	drivers = config_drivers_of(&room, cameras, no_displays, no_buttons);
	assert_string_equal(drivers.list[CONFIG_CAMERA][CONFIG_DRIVERS_MAX - 1].name, "one");
	assert_null(drivers.list[CONFIG_BUTTONS][0].name);
	config_destroy(fresh(&drivers));
	cameras[CONFIG_DRIVERS_MAX] = &camera;
	drivers = config_drivers_of(&room, cameras, no_displays, no_buttons);
	assert_int_equal(config_create(&c, &drivers), -E2BIG);
}

TEST("sample equals the defaults")
{
	struct config *bare = fresh(driver_list()), *sample = fresh(driver_list());
	struct ini_report report = {.count = 0};
	char *text = printed(bare, config_write_sample), *bare_text, *sample_text;

	/* the sample defines two cameras; the other file defines them empty */
	assert_int_equal(config_read_memory(bare, "[camera fisheye]\n[camera background]\n", 36,
					    "b", &report),
			 0);
	if (config_read_memory(sample, text, strlen(text), "s", &report))
		fail_msg("%s", report.first.text);
	bare_text = printed(bare, config_print);
	sample_text = printed(sample, config_print);
	assert_string_equal(bare_text, sample_text);
	free(text);
	free(bare_text);
	free(sample_text);
	config_destroy(bare);
	config_destroy(sample);
}
