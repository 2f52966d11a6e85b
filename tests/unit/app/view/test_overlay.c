/* SPDX-License-Identifier: MIT */
/* Text over the picture: where it is drawn, when it is drawn anew, and that it can be read. */
#include <dlfcn.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "app/view/show.h"
#include "app/view/words.h"
#include "hal/base/utf8.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/guarded_screen.h"
#include "tests/support/test.h"

#if WITH_CAIRO

static int lines_drawn;
static int line_letters[64]; /* letters of the first lines */

void cairo_show_glyphs(void *cairo, const void *glyphs, int count);

/* In place of cairo's own function: counts the glyphs and calls it. */
void cairo_show_glyphs(void *cairo, const void *glyphs, int count)
{
	void (*real)(void *, const void *, int);

	*(void **)&real = dlsym(RTLD_NEXT, "cairo_show_glyphs");
	if (lines_drawn < 64)
		line_letters[lines_drawn] = count;
	lines_drawn++;
	real(cairo, glyphs, count);
}

static const char figures[] =
	"lights 212 of 406 · threshold 32 · error ≤ 1.4 levels · 29.9 frames/s · latency 38 ms · 12 dropped · sky clipped 0.3 %";

static void give_troubles(struct overlay *overlay, int count)
{
	static char texts[OVERLAY_TROUBLES_MAX][OVERLAY_TEXT_MAX];

	for (int i = 0; i < count; i++)
		words_camera(texts[i], sizeof(texts[i]), "Background", "HD Pro Webcam C920",
			     (enum camera_situation)(1 + i), "");
	overlay_troubles(overlay, (const char(*)[OVERLAY_TEXT_MAX])texts, count);
}

/* Text drawn over two screens with different contents. Pixels that differ afterwards are untouched;
 * the others are text and do not depend on the contents. */
struct drawn {
	struct guarded_screen one, other;
};

static struct drawn test_overlay_draw(struct overlay *overlay, int width, int height)
{
	struct drawn d = {guarded_screen_create(width, height, 0x11),
			  guarded_screen_create(width, height, 0xee)};

	assert_int_equal(overlay_draw(overlay, &d.one.buffer), 0);
	assert_int_equal(overlay_draw(overlay, &d.other.buffer), 0);
	return d;
}

static bool is_text(const struct drawn *d, int x, int y)
{
	static const uint8_t one[4] = {0x11, 0x11, 0x11, 0x11}, other[4] = {0xee, 0xee, 0xee, 0xee};
	const uint8_t *a = guarded_screen_pixel(&d->one, x, y),
		      *b = guarded_screen_pixel(&d->other, x, y);

	if (!memcmp(a, one, 4) && !memcmp(b, other, 4))
		return false;
	assert_memory_equal(a, b, 4);
	assert_int_equal(a[3], 255);
	return true;
}

static int text_pixels(const struct drawn *d, int from_y, int to_y)
{
	int count = 0;

	for (int y = from_y; y < to_y; y++) {
		for (int x = 0; x < d->one.buffer.width; x++)
			count += is_text(d, x, y);
	}
	return count;
}

static void done(struct drawn *d)
{
	guarded_screen_free(&d->one);
	guarded_screen_free(&d->other);
}

TEST("nothing to say draws nothing")
{
	struct overlay overlay = {.trouble_count = 0};
	struct drawn d = test_overlay_draw(&overlay, 320, 240);

	assert_int_equal(text_pixels(&d, 0, 240), 0);
	done(&d);
	overlay_information(&overlay, NULL);
	overlay_information(&overlay, "");
	overlay_troubles(&overlay, NULL, 0);
	overlay_free(&overlay);
	overlay_free(&overlay);
}

/* Boxes of whole rows: problems at the top, figures at the bottom, the middle third free, at every
 * size. */
TEST("keeps to its edges")
{
	struct chance chance = chance_begin("keeps_to_its_edges");
	static const int sizes[][2] = {{160, 120}, {320, 240},	 {640, 480},   {720, 486},
				       {800, 480}, {1280, 800},	 {1920, 1080}, {480, 800},
				       {40, 480},  {3840, 2160}, {1, 1},       {2000, 30}};
	const int listed = sizeof(sizes) / sizeof(*sizes);

	for (int run = 0; run < listed + 60; run++) {
		int width = run < listed ? sizes[run][0] : chance_int(&chance, 1, 400);
		int height = run < listed ? sizes[run][1] : chance_int(&chance, 1, 400);
		struct overlay overlay = {.trouble_count = 0};
		struct drawn d;

		overlay_information(&overlay, figures);
		give_troubles(&overlay, run < listed ? 6 : chance_int(&chance, 0, 6));
		d = test_overlay_draw(&overlay, width, height);
		assert_int_equal(text_pixels(&d, height / 3, height - height / 3), 0);
		for (int y = height - height / 3; y < height; y++) {
			for (int x = 1; x < width; x++)
				expect_equal(is_text(&d, x, y), is_text(&d, 0, y),
					     "run=%d, y=%d, x=%d", run, y, x);
		}
		if (width >= 160 && height >= 120) {
			expect_that(is_text(&d, 0, height - 1), "run=%d", run);
			expect_equal(is_text(&d, width / 2, 0), overlay.trouble_count > 0, "run=%d",
				     run);
		}
		done(&d);
		overlay_free(&overlay);
	}
}

TEST("is drawn only when it changes")
{
	struct overlay overlay = {.trouble_count = 0};
	struct guarded_screen screen = guarded_screen_create(640, 480, 0);
	struct guarded_screen larger = guarded_screen_create(1280, 720, 0);
	int before;

	overlay_information(&overlay, figures);
	give_troubles(&overlay, 3);
	lines_drawn = 0;
	assert_int_equal(overlay_draw(&overlay, &screen.buffer), 0);
	assert_true(lines_drawn >= 4);
	before = lines_drawn;
	for (int i = 0; i < 50; i++) {
		overlay_information(&overlay, figures);
		give_troubles(&overlay, 3);
		assert_int_equal(overlay_draw(&overlay, &screen.buffer), 0);
	}
	assert_int_equal(lines_drawn, before);
	overlay_information(&overlay, "lights 1 of 2"); /* the other panel stays */
	assert_int_equal(overlay_draw(&overlay, &screen.buffer), 0);
	assert_int_equal(lines_drawn, before + 1);
	give_troubles(&overlay, 1);
	assert_int_equal(overlay_draw(&overlay, &screen.buffer), 0);
	assert_int_equal(lines_drawn, before + 2);
	assert_int_equal(overlay_draw(&overlay, &larger.buffer), 0);
	assert_int_equal(lines_drawn, before + 4);
	guarded_screen_free(&screen);
	guarded_screen_free(&larger);
	overlay_free(&overlay);
}

TEST("goes when it is taken back")
{
	struct overlay overlay = {.trouble_count = 0};
	struct drawn d;

	overlay_information(&overlay, figures);
	give_troubles(&overlay, 2);
	d = test_overlay_draw(&overlay, 640, 480);
	assert_true(text_pixels(&d, 0, 160) > 0);
	assert_true(text_pixels(&d, 320, 480) > 0);
	done(&d);
	give_troubles(&overlay, 0);
	d = test_overlay_draw(&overlay, 640, 480);
	assert_int_equal(text_pixels(&d, 0, 160), 0);
	assert_true(text_pixels(&d, 320, 480) > 0);
	done(&d);
	overlay_information(&overlay, NULL);
	d = test_overlay_draw(&overlay, 640, 480);
	assert_int_equal(text_pixels(&d, 0, 480), 0);
	done(&d);
	overlay_free(&overlay);
}

/* The upper edge of the strip and its number of lines stay while figures get longer and shorter. */
TEST("figures do not make it jump")
{
	static const int sizes[][2] = {{320, 240}, {640, 480}, {1024, 600}, {1920, 1080}};

	for (int s = 0; s < 4; s++) {
		struct overlay overlay = {.trouble_count = 0};
		int width = sizes[s][0], height = sizes[s][1], top = 0;
		char text[OVERLAY_TEXT_MAX];

		for (int i = 0; i < 40; i++) {
			/* the longest figures first */
			const struct words_figures f = {
				.lights_used = i ? i * 10 : 406,
				.lights = 406,
				.threshold = i ? i % 10 : 100,
				.error = i ? 0.1 * i : 99.9,
				.frames_a_second = i ? 7.5 : 29.9,
				.latency_ms = i ? i : 100,
				.drops = i ? 1 : 99999,
				.clipped = i ? 0 : 1,
			};
			struct drawn d;
			int y = 0;

			words_information(text, sizeof(text), &f);
			overlay_information(&overlay, text);
			d = test_overlay_draw(&overlay, width, height);
			while (y < height && !is_text(&d, 0, y))
				y++;
			expect_below(y, height, "s=%d, i=%d", s, i);
			if (i == 0)
				top = y;
			expect_at_least(y, top, "s=%d, i=%d", s, i);
			expect_that(i < 2 || y == top, "s=%d, i=%d", s, i);
			top = y;
			done(&d);
		}
		overlay_free(&overlay);
	}
}

static const char *behind(const char *text, int letters)
{
	while (letters--)
		text += utf8_bytes(text);
	return text;
}

/* Figures break only at " · ", which is then left out; sentences break between words; other texts
 * break anywhere. */
TEST("lines end where they may")
{
	static const struct {
		const char *text, *end;
	} cases[] = {
		{figures, " · "},
		{"Background camera 'HD Pro Webcam C920' is used by another program: waiting", " "},
		{"/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1.4.3.2.1:1.0-video-index0-or-another",
		 ""},
	};

	for (int i = 0; i < 3; i++) {
		struct overlay overlay = {.trouble_count = 0};
		struct guarded_screen screen = guarded_screen_create(320, 240, 0);
		const char *at = cases[i].text;

		overlay_information(&overlay, at);
		lines_drawn = 0;
		assert_int_equal(overlay_draw(&overlay, &screen.buffer), 0);
		expect_above(lines_drawn, 1, "i=%d", i);
		for (int line = 0; line < lines_drawn; line++) {
			at = behind(at, line_letters[line]);
			if (line == lines_drawn - 1)
				break;
			assert_memory_equal(at, cases[i].end, strlen(cases[i].end));
			at += strlen(cases[i].end);
		}
		assert_string_equal(at, "");
		guarded_screen_free(&screen);
		overlay_free(&overlay);
	}
}

/* Sentences for which there is no room are counted, and a last line says how many there are. */
TEST("what is left out is counted")
{
	struct overlay overlay = {.trouble_count = 0};
	struct guarded_screen screen = guarded_screen_create(240, 180, 0);
	static char texts[6][OVERLAY_TEXT_MAX];

	for (int i = 0; i < 6; i++)
		memcpy(texts[i], "a camera is gone", 17); /* each on a line of its own */
	overlay_troubles(&overlay, (const char(*)[OVERLAY_TEXT_MAX])texts, 6);
	lines_drawn = 0;
	assert_int_equal(overlay_draw(&overlay, &screen.buffer), 0);
	assert_true(lines_drawn > 2 && lines_drawn < 6);
	for (int line = 0; line < lines_drawn - 1; line++)
		expect_equal(line_letters[line], 16, "line=%d", line);
	assert_int_equal(line_letters[lines_drawn - 1], strlen("and 2 more"));
	guarded_screen_free(&screen);
	overlay_free(&overlay);
}

static double luminance(const uint8_t bgr[4])
{
	double linear[3];

	for (int c = 0; c < 3; c++) {
		double v = bgr[c] / 255.0;

		linear[c] = v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
	}
	return 0.0722 * linear[0] + 0.7152 * linear[1] + 0.2126 * linear[2];
}

/* Contrast by the Web Content Accessibility Guidelines, whose strictest limit is 7. Letters are as
 * high as promised, counted in rows with bright pixels. */
TEST("can be read")
{
	static const int sizes[][2] = {{160, 120}, {640, 480}, {1920, 1080}, {3840, 2160}};

	for (int s = 0; s < 4; s++) {
		struct overlay overlay = {.trouble_count = 0};
		int width = sizes[s][0], height = sizes[s][1], rows = 0, bright_pixels = 0;
		double dark = 1, bright = 0;
		struct drawn d;

		overlay_information(&overlay, "HHHH");
		d = test_overlay_draw(&overlay, width, height);
		for (int y = height * 2 / 3; y < height; y++) {
			bool seen = false;

			for (int x = 2; x < width && is_text(&d, x, y); x++) {
				double l = luminance(guarded_screen_pixel(&d.one, x, y));

				dark = fmin(dark, l);
				bright = fmax(bright, l);
				seen |= l > 0.5;
				bright_pixels += l > 0.5;
			}
			rows += seen;
		}
		expect_at_least((bright + 0.05) / (dark + 0.05), 7, "s=%d", s);
		/* a capital is 0.73 of the size, which is a thirtieth of the height, or 14
		 * pixels */
		expect_at_least(rows, fmax(height / 30.0, 14) * 0.73 - 1.5, "s=%d", s);
		expect_above(bright_pixels, rows * 4, "s=%d", s);
		done(&d);
		overlay_free(&overlay);
	}
}

/* Names of devices may be any bytes: they are cut, made valid and drawn. */
TEST("any bytes")
{
	struct chance chance = chance_begin("any_bytes");
	static const int sizes[][2] = {{640, 480}, {160, 120}, {37, 90}};

	for (int run = 0; run < 150; run++) {
		char texts[OVERLAY_TROUBLES_MAX][OVERLAY_TEXT_MAX];
		struct overlay overlay = {.trouble_count = 0};
		struct drawn d;

		for (int t = 0; t < OVERLAY_TROUBLES_MAX; t++) {
			int length = chance_int(&chance, 0, OVERLAY_TEXT_MAX - 1);
			int least = run % 2 ? 0xa0 : 1;

			for (int i = 0; i < length; i++)
				texts[t][i] = (char)chance_int(&chance, least, 255);
			texts[t][length] = '\0';
		}
		overlay_troubles(&overlay, (const char(*)[OVERLAY_TEXT_MAX])texts,
				 chance_int(&chance, 0, 9) % (OVERLAY_TROUBLES_MAX + 1));
		overlay_information(&overlay, texts[0]);
		for (const char *at = overlay.information; *at; at += utf8_bytes(at))
			expect_above(utf8_bytes(at), 0, "run=%d", run);
		d = test_overlay_draw(&overlay, sizes[run % 3][0], sizes[run % 3][1]);
		assert_int_equal(text_pixels(&d, sizes[run % 3][1] / 3,
					     sizes[run % 3][1] - sizes[run % 3][1] / 3),
				 0);
		done(&d);
		overlay_free(&overlay);
	}
}

/* The font has few of these characters; none may keep the others from being drawn. */
TEST("every character")
{
	struct guarded_screen screen = guarded_screen_create(320, 240, 0);
	struct overlay overlay = {.trouble_count = 0};

	for (uint32_t code = 0x80; code < 0x110000; code += 40) {
		char text[OVERLAY_TEXT_MAX];
		int length = 0;

		for (uint32_t c = code; c < code + 40; c++) {
			if (c >= 0x10000)
				text[length++] = (char)(0xf0 | c >> 18);
			if (c >= 0x800)
				text[length++] = (char)(c >= 0x10000 ? 0x80 | (c >> 12 & 0x3f)
								     : 0xe0 | c >> 12);
			text[length++] = (char)(c >= 0x800 ? 0x80 | (c >> 6 & 0x3f)
							   : 0xc0 | c >> 6);
			text[length++] = (char)(0x80 | (c & 0x3f));
		}
		text[length] = '\0';
		/* all planes have the same rules, so a sample of each is enough */
		if (code > 0x11000 && (code & 0xffff) > 0x400 && (code & 0xffff) < 0xff00)
			continue;
		overlay_information(&overlay, text);
		assert_int_equal(overlay_draw(&overlay, &screen.buffer), 0);
	}
	guarded_screen_free(&screen);
	overlay_free(&overlay);
}

TEST("longer than there is room for")
{
	struct overlay overlay = {.trouble_count = 0};
	char text[4 * OVERLAY_TEXT_MAX];
	struct drawn d;

	for (size_t i = 0; i + 2 < sizeof(text); i += 2)
		memcpy(text + i, "ä", 3);
	overlay_information(&overlay, text); /* without a blank */
	assert_int_equal(strlen(overlay.information), OVERLAY_TEXT_MAX - 2);
	d = test_overlay_draw(&overlay, 320, 240);
	assert_true(is_text(&d, 0, 239));
	done(&d);
	overlay_free(&overlay);
}

#else

/* Without cairo nothing is drawn, and nothing fails. */
TEST("without cairo")
{
	struct overlay overlay = {.trouble_count = 0};
	struct guarded_screen screen = guarded_screen_create(64, 48, 0x11);

	overlay_information(&overlay, "lights 1 of 2");
	for (int i = 0; i < 3; i++)
		assert_int_equal(overlay_draw(&overlay, &screen.buffer), 0);
	for (int y = 0; y < 48; y++) {
		for (int x = 0; x < 64; x++)
			expect_equal(*guarded_screen_pixel(&screen, x, y), 0x11, "y=%d, x=%d", y,
				     x);
	}
	guarded_screen_free(&screen);
	overlay_free(&overlay);
}

#endif
