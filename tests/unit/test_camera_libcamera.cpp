/*
 * What the libcamera driver decides by itself: values of controls, what becomes of refusals, choice
 * of format, colours, times. Everything that needs a camera is tests/vm/test_libcamera.sh's.
 *
 * The driver's parts are its own, so the file is included.
 */
#include "drivers/camera_libcamera.cpp"

#include <csetjmp>
#include <cstdarg>
#include <cstddef>

extern "C" {
#include <cmocka.h> /* after C++'s own: it defines a macro fail */
}

namespace
{

/* What was logged since it was made. */
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

/* A camera's controls as a Raspberry Pi's would be. */
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

std::string parsed(const lc::ControlId &id, const char *text)
{
	const lc::ControlInfoMap known = some_controls();

	try {
		return value_text(parse_value(id, known.find(&id)->second, text));
	} catch (const std::runtime_error &why) {
		return std::string("refused: ") + why.what();
	}
}

void test_values(void **)
{
	assert_string_equal(parsed(lc::controls::AeEnable, "no").c_str(), "no");
	assert_string_equal(parsed(lc::controls::AeEnable, " ON ").c_str(), "yes");
	assert_string_equal(parsed(lc::controls::AeEnable, "1").c_str(), "yes");
	assert_string_equal(parsed(lc::controls::ExposureTime, "10000").c_str(), "10000");
	assert_string_equal(parsed(lc::controls::AnalogueGain, "2.5").c_str(), "2.5");
	assert_string_equal(parsed(lc::controls::ColourGains, "1.5 2").c_str(), "1.5 2");
	assert_string_equal(parsed(lc::controls::FrameDurationLimits, "33333 33333").c_str(),
			    "33333 33333");
}

void test_values_that_cannot_be(void **)
{
	assert_string_equal(parsed(lc::controls::ExposureTime, "99").c_str(),
			    "refused: 99 is out of its range 100..66666");
	assert_string_equal(parsed(lc::controls::ExposureTime, "1e30").c_str(),
			    "refused: 1e30 is out of its range 100..66666");
	assert_string_equal(parsed(lc::controls::ExposureTime, "100.5").c_str(),
			    "refused: it takes whole numbers, not 100.5");
	assert_string_equal(parsed(lc::controls::ExposureTime, "long").c_str(),
			    "refused: \"long\" is no value for it");
	assert_string_equal(parsed(lc::controls::AnalogueGain, "nan").c_str(),
			    "refused: \"nan\" is no value for it");
	assert_string_equal(parsed(lc::controls::AeEnable, "2").c_str(),
			    "refused: 2 is out of its range no..yes");
	assert_string_equal(parsed(lc::controls::ExposureTime, "").c_str(),
			    "refused: expected 1 value, not 0");
	assert_string_equal(parsed(lc::controls::ExposureTime, "100 200").c_str(),
			    "refused: expected 1 value, not 2");
	assert_string_equal(parsed(lc::controls::ColourGains, "1.5").c_str(),
			    "refused: expected 2 values with blanks between, not 1");
	assert_string_equal(parsed(lc::controls::ScalerCrop, "0 0 64 64").c_str(),
			    "refused: its kind cannot be set from a configuration");
}

void test_wishes(void **)
{
	const lc::ControlInfoMap known = some_controls();
	lc::ControlList carried(lc::controls::controls), later(lc::controls::controls);
	const Said said;
	Wishes wishes;

	wishes.parse("cam", known, "exposuretime = 10000 , AeEnable=no,, Sparkle=1, AnalogueGain");
	wishes.put(carried);
	wishes.put(later);
	assert_int_equal(carried.size(), 2);
	assert_true(carried.contains(lc::controls::ExposureTime.id()));
	assert_true(later.empty());
	assert_int_equal(said.lines(), 2);
	assert_true(holds(said.text(), "cam: control Sparkle is not set: the camera has no such"));
	assert_true(holds(said.text(), "control AnalogueGain is not set: expected 1 value"));
}

/* A camera that refuses one of several refuses the request: each goes alone, and one has a name. */
void test_refusals_are_told_apart(void **)
{
	const lc::ControlInfoMap known = some_controls();
	lc::ControlList all(lc::controls::controls);
	const Said said;
	Wishes wishes;
	int carried = 0;

	wishes.parse("cam", known, "ExposureTime=10000, AeEnable=no, AnalogueGain=2");
	wishes.put(all);
	wishes.refused(all);
	assert_int_equal(said.lines(), 0);
	for (int i = 0; i < 5; i++) {
		lc::ControlList one(lc::controls::controls);

		wishes.put(one);
		assert_true(one.size() <= 1);
		carried += (int)one.size();
		if (one.contains(lc::controls::AeEnable.id()))
			wishes.refused(one);
	}
	assert_int_equal(carried, 3);
	assert_int_equal(said.lines(), 1);
	assert_true(holds(said.text(), "control AeEnable: the camera refused no"));
}

void test_reading_back(void **)
{
	const lc::ControlInfoMap known = some_controls();
	lc::ControlList metadata(lc::controls::controls);
	const Said said;
	Wishes wishes;

	wishes.parse("cam", known, "ExposureTime=10000, AnalogueGain=2, AeEnable=no");
	/* At first it is still what it was; then the sensor's nearest steps; one never is. */
	metadata.set(lc::controls::ExposureTime.id(), lc::ControlValue(33000));
	metadata.set(lc::controls::AnalogueGain.id(), lc::ControlValue(1.0f));
	for (int i = 0; i < 5; i++)
		wishes.read_back(metadata);
	metadata.set(lc::controls::ExposureTime.id(), lc::ControlValue(9987));
	for (int i = 0; i < 100; i++)
		wishes.read_back(metadata);
	assert_int_equal(said.lines(), 1);
	assert_true(holds(said.text(), "control AnalogueGain: asked for 2, it uses 1"));
}

void test_rates(void **)
{
	const lc::ControlInfoMap known = some_controls();
	Wishes wishes;

	assert_true(std::abs(wishes.want_rate(known, 30) - 30) < 0.001);
	assert_true(std::abs(wishes.want_rate(known, 1000) - 1e6 / 8333) < 0.001);
	assert_true(wishes.want_rate(known, 0) == 0);
	assert_true(wishes.want_rate(lc::ControlInfoMap({}, lc::controls::controls), 30) == 0);
}

void test_choice_of_format(void **)
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
	assert_true(any[0] == lc::formats::YUYV && any[1] == lc::formats::NV12 &&
		    any[2] == lc::formats::MJPEG);
	/* One that has the size goes before a cheaper one that has not. */
	const auto big = candidates(formats, PIXEL_NONE, large);

	assert_true(big[0] == lc::formats::NV12 && big[1] == lc::formats::MJPEG &&
		    big[2] == lc::formats::YUYV);
	assert_int_equal(candidates(formats, PIXEL_MJPEG, small).size(), 1);
	assert_int_equal(candidates(formats, PIXEL_GREY, small).size(), 0);
	/* Of a camera that does not tell, ours are tried one after another. */
	assert_int_equal(candidates(lc::StreamFormats(), PIXEL_NONE, small).size(),
			 sizeof(layouts) / sizeof(layouts[0]));
}

void test_colours(void **)
{
	lc::StreamConfiguration stream;

	stream.pixelFormat = lc::formats::NV12;
	stream.size = lc::Size(640, 480);
	assert_int_equal(matrix_of(stream, 0), MATRIX_BT601);
	assert_int_equal(range_of(stream, 0), RANGE_LIMITED);
	stream.size = lc::Size(1280, 720);
	assert_int_equal(matrix_of(stream, 0), MATRIX_BT709);
	stream.colorSpace = lc::ColorSpace::Smpte170m;
	assert_int_equal(matrix_of(stream, 0), MATRIX_BT601);
	stream.colorSpace = lc::ColorSpace::Rec709;
	stream.colorSpace->range = lc::ColorSpace::Range::Full;
	assert_int_equal(matrix_of(stream, 0), MATRIX_BT709);
	assert_int_equal(range_of(stream, 0), RANGE_FULL);
	/* Settings overrule it. */
	assert_int_equal(matrix_of(stream, MATRIX_BT601 + 1), MATRIX_BT601);
	assert_int_equal(range_of(stream, RANGE_LIMITED + 1), RANGE_LIMITED);
	stream.pixelFormat = lc::formats::RGB888;
	stream.colorSpace.reset();
	assert_int_equal(range_of(stream, 0), RANGE_FULL);
}

void test_times(void **)
{
	const int64_t now_ns = clock_now_ns();
	timespec boot;

	assert_true(monotonic_ns(now_ns - 5 * NS_PER_MS) == now_ns - 5 * NS_PER_MS);
	assert_true(monotonic_ns(0) >= now_ns);
	assert_true(monotonic_ns(now_ns + 1000 * NS_PER_S) >= now_ns);
	clock_gettime(CLOCK_BOOTTIME, &boot);
	assert_true(monotonic_ns((int64_t)boot.tv_sec * NS_PER_S + boot.tv_nsec) <= clock_now_ns());
}

void test_messages(void **)
{
	const Said said;
	Messages messages;
	std::ostream stream(&messages);
	const std::string head = "[0:01:02.000000000] [42] ";
	const std::string bad = head + "ERROR V4L2 v4l2.cpp:1 /dev/video0: Failed\n";
	const std::string fine = head + " INFO Camera camera_manager.cpp:299 libcamera v0.0.3\n";

	for (int i = 0; i < 3; i++)
		stream.write(bad.data(), (std::streamsize)bad.size());
	stream.write(fine.data(), (std::streamsize)fine.size());
	assert_string_equal(said.text().c_str(),
			    "inlay: libcamera: ERROR V4L2 v4l2.cpp:1 /dev/video0: Failed\n");
}

} // namespace

int main()
{
	const CMUnitTest tests[] = {
		cmocka_unit_test(test_values),
		cmocka_unit_test(test_values_that_cannot_be),
		cmocka_unit_test(test_wishes),
		cmocka_unit_test(test_refusals_are_told_apart),
		cmocka_unit_test(test_reading_back),
		cmocka_unit_test(test_rates),
		cmocka_unit_test(test_choice_of_format),
		cmocka_unit_test(test_colours),
		cmocka_unit_test(test_times),
		cmocka_unit_test(test_messages),
	};

	return cmocka_run_group_tests(tests, nullptr, nullptr);
}
