/* SPDX-License-Identifier: MIT */
/* What the libcamera driver decides by itself: values of controls, refusals, choice of format,
 * colours. test_libcamera_parts.c tests its parts in C; tests/vm/test_libcamera.sh what needs a
 * camera. */
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#define LIBCAMERA_BASE_PRIVATE
#include <libcamera/base/semaphore.h>

#include "drivers/libcamera/driver.hpp"
#include "tests/support/test.h"

extern "C" {
#include <cmocka.h> /* after C++ headers, because it defines a macro named fail */
}

using namespace libcamera_driver;

namespace
{
pthread_mutex_t *watched; /* of a semaphore: its first member */
int notified, notified_unlocked;
} // namespace

/* Replaces libc's, for libstdc++ as well; nobody waits in this program. */
extern "C" int pthread_cond_broadcast(pthread_cond_t *)
{
	notified++;
	if (watched && pthread_mutex_trylock(watched) == 0) {
		notified_unlocked++;
		pthread_mutex_unlock(watched);
	}
	return 0;
}

namespace
{

/* Collects what is logged while it exists. */
class Said
{
      public:
	Said() : file(memfd_create("said", MFD_CLOEXEC)), saved(dup(STDERR_FILENO))
	{
		dup2(file, STDERR_FILENO);
	}

	~Said()
	{
		dup2(saved, STDERR_FILENO);
		close(saved);
		close(file);
	}

	std::string text() const
	{
		char buffer[4096];
		const ssize_t length = pread(file, buffer, sizeof(buffer), 0);

		return std::string(buffer, length > 0 ? (size_t)length : 0);
	}

	int lines() const
	{
		const std::string said = text();

		return (int)std::count(said.begin(), said.end(), '\n');
	}

      private:
	const int file, saved;
};

bool holds(const std::string &text, const char *part)
{
	return text.find(part) != text.npos;
}

/* The controls of a camera on a Raspberry Pi. */
lc::ControlInfoMap some_controls()
{
	lc::ControlInfoMap::Map map;

	map.emplace(&lc::controls::AeEnable, lc::ControlInfo(false, true));
	map.emplace(&lc::controls::ExposureTime, lc::ControlInfo(100, 66666));
	map.emplace(&lc::controls::AnalogueGain, lc::ControlInfo(1.0f, 16.0f));
	map.emplace(&lc::controls::ColourGains, lc::ControlInfo(0.0f, 32.0f));
	map.emplace(&lc::controls::FrameDurationLimits,
		    lc::ControlInfo(INT64_C(8333), INT64_C(1000000)));
	map.emplace(&lc::controls::ScalerCrop,
		    lc::ControlInfo(lc::Rectangle(0, 0, 64, 64), lc::Rectangle(0, 0, 640, 480)));
	return lc::ControlInfoMap(std::move(map), lc::controls::controls);
}

/* Value that goes with a request after a control was set, both as text. */
std::string sent(const lc::ControlId &id, const char *text)
{
	for (const libcamera_control &control : controls_of(some_controls())) {
		lc::ControlList list(lc::controls::controls);
		libcamera_wishes wishes = {};
		char as_text[LIBCAMERA_VALUE_TEXT_MAX];
		fault why;

		if (control.theirs != &id)
			continue;
		if (libcamera_value_read(&control, text, &wishes.list[0].value, &why))
			return std::string("refused: ") + why.text;
		wishes.list[0].control = &control;
		wishes.count = 1;
		put_wishes(wishes, list);
		const libcamera_value value = numbers_of(list.get(id.id()));

		libcamera_value_text(&value, as_text);
		return as_text;
	}
	return "not known";
}

/* What was asked of a camera with those controls. */
struct Asked {
	explicit Asked(const char *text, double rate_hz = 0) : known(controls_of(some_controls()))
	{
		rate = libcamera_wishes_read(&wishes, "cam", known.data(), (int)known.size(), text,
					     rate_hz);
	}

	std::vector<libcamera_control> known;
	libcamera_wishes wishes;
	double rate;
};

TEST("values")
{
	assert_string_equal(sent(lc::controls::AeEnable, "no").c_str(), "no");
	assert_string_equal(sent(lc::controls::AeEnable, " ON ").c_str(), "yes");
	assert_string_equal(sent(lc::controls::AeEnable, "1").c_str(), "yes");
	assert_string_equal(sent(lc::controls::ExposureTime, "10000").c_str(), "10000");
	assert_string_equal(sent(lc::controls::AnalogueGain, "2.5").c_str(), "2.5");
	assert_string_equal(sent(lc::controls::ColourGains, "1.5 2").c_str(), "1.5 2");
	assert_string_equal(sent(lc::controls::FrameDurationLimits, "33333 33333").c_str(),
			    "33333 33333");
}

TEST("values that cannot be")
{
	assert_string_equal(sent(lc::controls::ExposureTime, "99").c_str(),
			    "refused: 99 is out of its range 100..66666");
	assert_string_equal(sent(lc::controls::ExposureTime, "1e30").c_str(),
			    "refused: 1e30 is out of its range 100..66666");
	assert_string_equal(sent(lc::controls::ExposureTime, "100.5").c_str(),
			    "refused: it takes whole numbers, not 100.5");
	assert_string_equal(sent(lc::controls::ExposureTime, "long").c_str(),
			    "refused: \"long\" is no value for it");
	assert_string_equal(sent(lc::controls::AnalogueGain, "nan").c_str(),
			    "refused: \"nan\" is no value for it");
	assert_string_equal(sent(lc::controls::AeEnable, "2").c_str(),
			    "refused: 2 is out of its range no..yes");
	assert_string_equal(sent(lc::controls::ExposureTime, "").c_str(),
			    "refused: expected 1 value, not 0");
	assert_string_equal(sent(lc::controls::ExposureTime, "100 200").c_str(),
			    "refused: expected 1 value, not 2");
	assert_string_equal(sent(lc::controls::ColourGains, "1.5").c_str(),
			    "refused: expected 2 values with blanks between, not 1");
	assert_string_equal(sent(lc::controls::ScalerCrop, "0 0 64 64").c_str(),
			    "refused: its kind cannot be set from a configuration");
}

TEST("wishes")
{
	lc::ControlList carried(lc::controls::controls), later(lc::controls::controls);
	const Said said;
	Asked asked(
		"exposuretime = 10000 , AeEnable=no,, Sparkle=1, AnalogueGain, AnalogueGain=2 3");

	put_wishes(asked.wishes, carried);
	put_wishes(asked.wishes, later);
	assert_int_equal(carried.size(), 2);
	assert_int_equal(carried.get(lc::controls::ExposureTime).value_or(0), 10000);
	assert_false(carried.get(lc::controls::AeEnable).value_or(true));
	assert_true(later.empty());
	assert_int_equal(said.lines(), 3);
	assert_true(holds(said.text(), "cam: control Sparkle is not set: the camera has no such"));
	assert_true(holds(said.text(), "cam: controls: \"AnalogueGain\", expected name=value"));
	assert_true(holds(said.text(), "control AnalogueGain is not set: expected 1 value"));
}

TEST("arrays")
{
	lc::ControlList carried(lc::controls::controls);
	Asked asked("ColourGains=1.5 2", 30);

	put_wishes(asked.wishes, carried);
	const auto gains = carried.get(lc::controls::ColourGains);
	const auto limits = carried.get(lc::controls::FrameDurationLimits);

	assert_true(gains && (*gains)[0] == 1.5f && (*gains)[1] == 2.0f);
	assert_true(limits && (*limits)[0] == 33333 && (*limits)[1] == 33333);
}

/* A camera that refuses one control refuses the whole request, so each is tried alone, and one is
 * named. */
TEST("refusals are told apart")
{
	lc::ControlList all(lc::controls::controls);
	const Said said;
	Asked asked("ExposureTime=10000, AeEnable=no, AnalogueGain=2");
	int carried = 0;

	libcamera_wishes_refused(&asked.wishes, put_wishes(asked.wishes, all));
	assert_int_equal(all.size(), 3);
	assert_int_equal(said.lines(), 0);
	for (int i = 0; i < 5; i++) {
		lc::ControlList one(lc::controls::controls);
		const libcamera_load load = put_wishes(asked.wishes, one);

		assert_true(one.size() <= 1);
		carried += (int)one.size();
		if (one.contains(lc::controls::AeEnable.id()))
			libcamera_wishes_refused(&asked.wishes, load);
	}
	assert_int_equal(carried, 3);
	assert_int_equal(said.lines(), 1);
	assert_true(holds(said.text(), "control AeEnable: the camera refused no"));
}

/* A change goes with the next request, and once more after what had already been queued. */
TEST("changes")
{
	const Said said;
	Asked asked("ExposureTime=10000, AnalogueGain=2");
	const auto change = [&](const char *name, const char *value) {
		fault why;

		return libcamera_wishes_change(&asked.wishes, asked.known.data(),
					       (int)asked.known.size(), name, value, &why);
	};
	const auto carried = [&] {
		lc::ControlList list(lc::controls::controls);

		put_wishes(asked.wishes, list);
		return list;
	};

	assert_int_equal(carried().size(), 2);
	assert_int_equal(carried().size(), 0);
	assert_int_equal(change("analoguegain", "4"), 0);
	auto next = carried();
	assert_int_equal(next.size(), 1);
	assert_true(*next.get(lc::controls::AnalogueGain) == 4.0f);
	assert_int_equal(change("ExposureTime", "500"), 0);
	next = carried();
	assert_true(*next.get(lc::controls::ExposureTime) == 500);
	assert_true(*next.get(lc::controls::AnalogueGain) == 4.0f);
	assert_int_equal(change("AeEnable", "no"), 0);
	assert_int_equal(carried().size(), 1);
	assert_int_equal(carried().size(), 0);
	assert_int_equal(change("Sparkle", "1"), -EINVAL);
	assert_int_equal(change("AnalogueGain", "much"), -EINVAL);
	assert_int_equal(change("AnalogueGain", "17"), -ERANGE);
	assert_int_equal(carried().size(), 0);
	assert_int_equal(said.lines(), 0);
}

TEST("reading back")
{
	lc::ControlList metadata(lc::controls::controls);
	const Said said;
	Asked asked("ExposureTime=10000, AnalogueGain=2, AeEnable=no");

	/* first still the old value, then the sensor's nearest steps; one is never reached */
	metadata.set(lc::controls::ExposureTime.id(), lc::ControlValue(33000));
	metadata.set(lc::controls::AnalogueGain.id(), lc::ControlValue(1.0f));
	for (int i = 0; i < 5; i++)
		libcamera_wishes_compare(&asked.wishes, used_value, &metadata);
	metadata.set(lc::controls::ExposureTime.id(), lc::ControlValue(9987));
	for (int i = 0; i < 100; i++)
		libcamera_wishes_compare(&asked.wishes, used_value, &metadata);
	assert_int_equal(said.lines(), 1);
	assert_true(holds(said.text(), "control AnalogueGain: asked for 2, it uses 1"));
}

TEST("rates")
{
	libcamera_wishes wishes;

	assert_true(std::abs(Asked("", 30).rate - 30) < 0.001);
	assert_true(std::abs(Asked("", 1000).rate - 1e6 / 8333) < 0.001);
	assert_true(Asked("", 0).rate == 0);
	assert_true(libcamera_wishes_read(&wishes, "cam", nullptr, 0, "", 30) == 0);
}

TEST("choice of format")
{
	const lc::Size small(640, 480), large(1920, 1080);
	const lc::StreamFormats formats({
		{lc::formats::MJPEG, {lc::SizeRange(small), lc::SizeRange(large)}},
		{lc::formats::YUYV, {lc::SizeRange(small)}},
		{lc::formats::NV12, {lc::SizeRange(lc::Size(32, 32), lc::Size(4096, 4096), 2, 2)}},
		{lc::formats::SRGGB10, {lc::SizeRange(large)}},
	});
	const auto any = candidates(formats, PIXEL_NONE, small);

	assert_int_equal(any.size(), 3);
	assert_true(any[0].theirs == lc::formats::YUYV && any[1].theirs == lc::formats::NV12 &&
		    any[2].theirs == lc::formats::MJPEG);
	/* a format that has the size goes before a cheaper one that has not */
	const auto big = candidates(formats, PIXEL_NONE, large);

	assert_true(big[0].theirs == lc::formats::NV12 && big[1].theirs == lc::formats::MJPEG &&
		    big[2].theirs == lc::formats::YUYV);
	assert_int_equal(candidates(formats, PIXEL_MJPEG, small).size(), 1);
	assert_int_equal(candidates(formats, PIXEL_GREY, small).size(), 0);
}

/* A camera that does not list its formats is tried with all that inlay reads. */
TEST("untold formats")
{
	const auto all = candidates(lc::StreamFormats(), PIXEL_NONE, lc::Size(640, 480));
	const auto ways = [&](pixel_format format) {
		return std::count_if(all.begin(), all.end(),
				     [&](const Layout &layout) { return layout.ours == format; });
	};

	for (const Layout &layout : all)
		assert_int_equal(format_of(layout.theirs), layout.ours);
	assert_int_equal(ways(PIXEL_BGRX), 2);
	for (const pixel_format format :
	     {PIXEL_YUYV, PIXEL_UYVY, PIXEL_NV12, PIXEL_RGB24, PIXEL_BGR24, PIXEL_GREY, PIXEL_MJPEG,
	      PIXEL_YVYU, PIXEL_NV16, PIXEL_NV21, PIXEL_YU12, PIXEL_YV12})
		assert_int_equal(ways(format), 1);
	assert_int_equal(all.size(), 14);
	assert_int_equal(format_of(lc::formats::SRGGB10), PIXEL_NONE);
}

TEST("colours")
{
	lc::StreamConfiguration stream;
	camera_settings settings = {};
	const auto matrix = [&] { return blank_frame(stream, settings).matrix; };
	const auto range = [&] { return blank_frame(stream, settings).range; };

	stream.pixelFormat = lc::formats::NV12;
	stream.size = lc::Size(640, 480);
	assert_int_equal(matrix(), MATRIX_BT601);
	assert_int_equal(range(), RANGE_LIMITED);
	stream.size = lc::Size(1280, 720);
	assert_int_equal(matrix(), MATRIX_BT709);
	stream.colorSpace = lc::ColorSpace::Smpte170m;
	assert_int_equal(matrix(), MATRIX_BT601);
	stream.colorSpace = lc::ColorSpace::Rec709;
	stream.colorSpace->range = lc::ColorSpace::Range::Full;
	assert_int_equal(matrix(), MATRIX_BT709);
	assert_int_equal(range(), RANGE_FULL);
	/* settings go first */
	settings.matrix = MATRIX_BT601 + 1;
	settings.range = RANGE_LIMITED + 1;
	assert_int_equal(matrix(), MATRIX_BT601);
	assert_int_equal(range(), RANGE_LIMITED);
	settings.range = 0;
	stream.pixelFormat = lc::formats::RGB888;
	stream.colorSpace.reset();
	assert_int_equal(range(), RANGE_FULL);
}

/* All frames of a stream have its properties. */
TEST("blank frame")
{
	lc::StreamConfiguration stream;

	stream.pixelFormat = lc::formats::RGB888;
	stream.size = lc::Size(636, 480);
	const frame blank = blank_frame(stream, {});

	assert_int_equal(blank.format, PIXEL_BGR24);
	assert_int_equal(blank.width, 636);
	assert_int_equal(blank.height, 480);
	assert_null(blank.planes[0].data);
}

/* libcamera writes a message in one piece. */
TEST("messages")
{
	const Said said;
	Messages messages;
	std::ostream stream(&messages);
	const std::string bad = "[0:01:02.000000000] [42] ERROR V4L2 v4l2.cpp:1 Failed\n";

	stream.write(bad.data(), (std::streamsize)bad.size());
	assert_string_equal(said.text().c_str(),
			    "inlay: libcamera: ERROR V4L2 v4l2.cpp:1 Failed\n");
}

/* Who waits for a semaphore destroys it as soon as he has the lock. */
TEST("semaphores notify while locked")
{
	lc::Semaphore semaphore;
	Dl_info used, own;

	watched = reinterpret_cast<pthread_mutex_t *>(&semaphore);
	notified = notified_unlocked = 0;
	semaphore.release();
	watched = nullptr;
	assert_int_equal(notified, 1);
	assert_int_equal(notified_unlocked, 0);
	assert_int_equal(semaphore.available(), 1);
	/* libcamera calls this function, too. */
	assert_true(dladdr(dlsym(RTLD_DEFAULT, "_ZN9libcamera9Semaphore7releaseEj"), &used));
	assert_true(dladdr(reinterpret_cast<void *>(test_group), &own));
	assert_ptr_equal(used.dli_fbase, own.dli_fbase);
}

} // namespace
