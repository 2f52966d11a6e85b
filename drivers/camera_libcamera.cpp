/*
 * Cameras behind libcamera: sensors on a board's camera connector, whose picture the board's own
 * image processor makes.
 *
 * C++, because libcamera is; kept in this file. Inside it a failure is an exception that says what
 * the screen is to say; every op catches all of them. Debian 12 has libcamera 0.0.3, Debian 13 0.4:
 * what differs between them is in Manager, control_elements() and control_words().
 */
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <dirent.h>
#include <fcntl.h>
#include <linux/dma-buf.h>
#include <strings.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <libcamera/libcamera.h>

extern "C" {
#include "drivers/drivers.h"
#include "hal/clock.h"
#include "hal/log.h"
}

#define LIBCAMERA_AT_LEAST(major, minor)                                                           \
	(LIBCAMERA_VERSION_MAJOR > (major) ||                                                      \
	 (LIBCAMERA_VERSION_MAJOR == (major) && LIBCAMERA_VERSION_MINOR >= (minor)))

namespace
{

namespace lc = libcamera;

class Failure : public std::runtime_error
{
      public:
	Failure(int code, camera_situation what, const std::string &text)
	    : std::runtime_error(text), err(code), situation(what)
	{
	}

	/* libcamera said err to what was tried. */
	Failure(int code, const char *tried)
	    : Failure(code, situation_of(code),
		      code == -ENOSPC
			      ? "the bus has no room for its pictures: ask for a smaller size "
				"or a lower rate"
			      : std::string(tried) + ": " + strerror(-code))
	{
	}

	const int err; /* negative errno */
	const camera_situation situation;

      private:
	static camera_situation situation_of(int code)
	{
		switch (code) {
		case -EBUSY:
			return CAMERA_BUSY;
		case -ENODEV:
		case -ENXIO:
		case -ENOENT:
			return CAMERA_NO_DEVICE;
		case -ENOSPC:
			return CAMERA_NO_BANDWIDTH;
		case -EACCES:
		case -EPERM:
			return CAMERA_NO_PERMISSION;
		default:
			return CAMERA_BROKEN;
		}
	}
};

/* ---- libcamera's own messages ----
 * Errors become warnings of ours, the rest is for debugging; LIBCAMERA_LOG_FILE leaves them alone.
 * A message that repeats (a device that went away fails at every frame) is said once. */
class Messages : public std::streambuf
{
      protected:
	/* One call is one whole message, as libcamera writes them. */
	std::streamsize xsputn(const char *text, std::streamsize length) override
	{
		std::string_view line(text, (size_t)length);

		while (!line.empty() && line.back() == '\n')
			line.remove_suffix(1);
		say(line);
		return length;
	}

	int overflow(int c) override
	{
		return c == EOF ? 0 : c;
	}

      private:
	/* "[time] [thread] LEVEL Category file:line text" */
	void say(std::string_view line)
	{
		const size_t head = line.find("] [");
		const size_t tail = head == line.npos ? line.npos : line.find(']', head + 3);
		const std::lock_guard<std::mutex> guard(lock);

		if (tail != line.npos)
			line.remove_prefix(tail + 1);
		while (!line.empty() && line.front() == ' ')
			line.remove_prefix(1);
		if (line.empty() || line == last)
			return;
		last = line;
		const bool error = line.substr(0, 5) == "ERROR" || line.substr(0, 5) == "FATAL";
		log_say(error ? LOG_LEVEL_WARNING : LOG_LEVEL_DEBUG, "libcamera: %s", last.c_str());
	}

	std::mutex lock;
	std::string last;
};

void redirect_messages()
{
	static std::once_flag once;

	std::call_once(once, [] {
		/* Never destroyed: libcamera's threads and its own end may still write. */
		static std::ostream *const stream = new std::ostream(new Messages);

		if (!getenv("LIBCAMERA_LOG_FILE"))
			lc::logSetStream(stream);
	});
}

/* ---- the manager ----
 * A process may have only one at a time: it lives as long as somebody holds one of these. */
class Manager
{
      public:
	Manager()
	{
		const std::lock_guard<std::mutex> guard(lock);

		if (users == 0) {
			redirect_messages();
			only = new lc::CameraManager;
			if (const int err = only->start(); err) {
				delete only;
				throw Failure(err, CAMERA_NO_DEVICE, "it finds no devices at all");
			}
		}
		users++;
	}

	~Manager()
	{
		const std::lock_guard<std::mutex> guard(lock);

		if (--users > 0)
			return;
		only->stop();
		delete only;
	}

	Manager(const Manager &) = delete;
	Manager &operator=(const Manager &) = delete;

	std::vector<std::shared_ptr<lc::Camera>> cameras() const
	{
		return only->cameras();
	}

	/* So that the camera may come back under its name: two of one name are fatal. libcamera
	 * wants to be told by its own thread; later versions have no way to be told. */
	void forget(const std::shared_ptr<lc::Camera> &camera) const
	{
#if LIBCAMERA_AT_LEAST(0, 4)
		(void)camera;
#else
		class Errand : public lc::Object
		{
		      public:
			void run(std::shared_ptr<lc::Camera> what)
			{
				only->removeCamera(what);
			}
		};
		Errand errand;

		errand.moveToThread(camera->thread());
		errand.invokeMethod(&Errand::run, lc::ConnectionTypeBlocking, camera);
#endif
	}

	/* The device, as in struct stat, is one that this camera is made of. */
	bool made_of(const std::shared_ptr<lc::Camera> &camera, dev_t number) const
	{
#if LIBCAMERA_AT_LEAST(0, 4)
		const auto numbers = camera->properties().get(lc::properties::SystemDevices);

		return numbers && std::find(numbers->begin(), numbers->end(), (int64_t)number) !=
					  numbers->end();
#else
		return only->get(number) == camera;
#endif
	}

      private:
	static std::mutex lock;
	static lc::CameraManager *only; /* no destructor: see libcamera_close() */
	static int users;
};

std::mutex Manager::lock;
lc::CameraManager *Manager::only;
int Manager::users;

std::string model_of(const lc::Camera &device)
{
	const auto model = device.properties().get(lc::properties::Model);

	return model ? std::string(*model) : std::string();
}

/* Why libcamera sees no camera. */
Failure nothing_found()
{
	std::unique_ptr<DIR, int (*)(DIR *)> dev(opendir("/dev"), closedir);
	int media = 0;

	while (const dirent *entry = dev ? readdir(dev.get()) : nullptr) {
		const std::string path = std::string("/dev/") + entry->d_name;

		if (strncmp(entry->d_name, "media", 5))
			continue;
		media++;
		if (access(path.c_str(), R_OK | W_OK) && errno == EACCES)
			return {-EACCES, CAMERA_NO_PERMISSION,
				"no permission for " + path +
					": the user must be in the group that owns it (video)"};
	}
	if (media == 0)
		return {-ENODEV, CAMERA_NO_DEVICE, "no camera: there is no /dev/media*"};
	if (access("/run/udev/data", F_OK))
		return {-ENODEV, CAMERA_NO_DEVICE,
			"no camera: libcamera finds them through udev, which is not running"};
	return {-ENODEV, CAMERA_NO_DEVICE,
		"no camera: libcamera has no pipeline handler for what is plugged in, or another "
		"program is setting it up"};
}

std::string names_of(const std::vector<std::shared_ptr<lc::Camera>> &cameras)
{
	std::string text;

	for (const auto &device : cameras)
		text += (text.empty() ? "" : ", ") + device->id() + " (" + model_of(*device) + ")";
	return text;
}

/* By id, else by model, else by a part of either; empty: the first. */
std::shared_ptr<lc::Camera> find(const Manager &manager, const std::string &wanted)
{
	const auto cameras = manager.cameras();

	if (cameras.empty())
		throw nothing_found();
	if (wanted.empty())
		return cameras.front();
	for (int step = 0; step < 3; step++) {
		std::vector<std::shared_ptr<lc::Camera>> found;

		for (const auto &device : cameras) {
			const std::string &id = device->id(), model = model_of(*device);

			if (step == 0	? id == wanted
			    : step == 1 ? model == wanted
					: strcasestr(id.c_str(), wanted.c_str()) ||
						  strcasestr(model.c_str(), wanted.c_str()))
				found.push_back(device);
		}
		if (found.size() == 1)
			return found.front();
		if (found.size() > 1)
			throw Failure(-EINVAL, CAMERA_BROKEN,
				      "\"" + wanted +
					      "\" fits more than one camera, expected one of " +
					      names_of(found));
	}
	throw Failure(-ENODEV, CAMERA_NO_DEVICE,
		      "no camera \"" + wanted + "\"; there is " + names_of(cameras));
}

/* ---- pictures ----
 * The first is the cheapest to convert. libcamera names formats as DRM does, from the most
 * significant byte of a word; we name them in the order of memory. */
struct Layout {
	lc::PixelFormat theirs;
	pixel_format ours;
};

const Layout layouts[] = {
	{lc::formats::XRGB8888, PIXEL_BGRX}, {lc::formats::ARGB8888, PIXEL_BGRX},
	{lc::formats::RGB888, PIXEL_BGR24},  {lc::formats::BGR888, PIXEL_RGB24},
	{lc::formats::YUYV, PIXEL_YUYV},     {lc::formats::UYVY, PIXEL_UYVY},
	{lc::formats::NV12, PIXEL_NV12},     {lc::formats::MJPEG, PIXEL_MJPEG},
	{lc::formats::R8, PIXEL_GREY},
};

pixel_format format_of(const lc::PixelFormat &theirs)
{
	for (const Layout &layout : layouts)
		if (layout.theirs == theirs)
			return layout.ours;
	return PIXEL_NONE;
}

bool is_range(const lc::SizeRange &range)
{
	return range.hStep > 0 && range.vStep > 0 && range.min != range.max;
}

bool offers_size(const lc::StreamFormats &formats, const lc::PixelFormat &format, lc::Size size)
{
	const auto sizes = formats.sizes(format);

	if (is_range(formats.range(format)))
		return formats.range(format).contains(size);
	return std::find(sizes.begin(), sizes.end(), size) != sizes.end();
}

/* The formats to try, best first: those that have the wanted size, by what converting them costs.
 * A camera that does not tell its formats is asked for each of ours. */
std::vector<lc::PixelFormat> candidates(const lc::StreamFormats &formats, int wanted, lc::Size size)
{
	const auto offered = formats.pixelformats();
	std::vector<lc::PixelFormat> sized, others;

	for (const Layout &layout : layouts) {
		if (wanted != PIXEL_NONE && layout.ours != wanted)
			continue;
		if (!offered.empty() &&
		    std::find(offered.begin(), offered.end(), layout.theirs) == offered.end())
			continue;
		(offers_size(formats, layout.theirs, size) ? sized : others)
			.push_back(layout.theirs);
	}
	sized.insert(sized.end(), others.begin(), others.end());
	return sized;
}

std::string offered_text(const lc::StreamFormats &formats)
{
	std::string text;

	for (const lc::PixelFormat &format : formats.pixelformats())
		text += (text.empty() ? "" : " ") + format.toString();
	return text.empty() ? "none" : text;
}

/* The configuration that will be used; libcamera may answer with another size, never with another
 * format than one of the candidates. */
std::unique_ptr<lc::CameraConfiguration> configure(lc::Camera &device,
						   const camera_settings &settings)
{
	auto configuration = device.generateConfiguration({lc::StreamRole::Viewfinder});

	if (!configuration || configuration->empty())
		throw Failure(-ENOTSUP, CAMERA_UNSUPPORTED_FORMAT, "it offers no stream");
	lc::StreamConfiguration &stream = configuration->at(0);
	const lc::StreamFormats formats = stream.formats();
	const lc::Size size(settings.width ? (unsigned)settings.width : stream.size.width,
			    settings.height ? (unsigned)settings.height : stream.size.height);

	for (const lc::PixelFormat &format : candidates(formats, settings.format, size)) {
		stream.pixelFormat = format;
		stream.size = size;
		stream.stride = 0;
		stream.bufferCount = (unsigned)settings.buffers;
		if (configuration->validate() == lc::CameraConfiguration::Invalid ||
		    stream.pixelFormat != format)
			continue;
		if (settings.width && settings.height && stream.size != size)
			log_info("libcamera: %s: asked for %dx%d, it gives %ux%u",
				 device.id().c_str(), settings.width, settings.height,
				 stream.size.width, stream.size.height);
		if (const int err = device.configure(configuration.get()); err)
			throw Failure(err, ("cannot set " + stream.toString()).c_str());
		return configuration;
	}
	throw Failure(-ENOTSUP, CAMERA_UNSUPPORTED_FORMAT,
		      "it offers " + offered_text(formats) + ", expected " +
			      (settings.format ? pixel_format_names[settings.format]
					       : "a format that inlay decodes"));
}

colour_matrix matrix_of(const lc::StreamConfiguration &stream, int wanted)
{
	if (wanted)
		return (colour_matrix)(wanted - 1);
	if (!stream.colorSpace ||
	    stream.colorSpace->ycbcrEncoding == lc::ColorSpace::YcbcrEncoding::None)
		return stream.size.height >= 720 ? MATRIX_BT709 : MATRIX_BT601;
	/* BT.2020, which we do not have, is nearest to BT.709. */
	return stream.colorSpace->ycbcrEncoding == lc::ColorSpace::YcbcrEncoding::Rec601
		       ? MATRIX_BT601
		       : MATRIX_BT709;
}

colour_range range_of(const lc::StreamConfiguration &stream, int wanted)
{
	if (wanted)
		return (colour_range)(wanted - 1);
	switch (format_of(stream.pixelFormat)) {
	case PIXEL_YUYV:
	case PIXEL_UYVY:
	case PIXEL_NV12:
		return stream.colorSpace && stream.colorSpace->range == lc::ColorSpace::Range::Full
			       ? RANGE_FULL
			       : RANGE_LIMITED;
	default: /* R'G'B' and grey fill it; libcamera knows no other R'G'B' */
		return RANGE_FULL;
	}
}

/* ---- controls ---- */

/* How many values a control takes: 0 for a single one that is no array. */
size_t control_elements(const lc::ControlId &id)
{
#if LIBCAMERA_AT_LEAST(0, 4)
	return id.isArray() ? id.size() : 0;
#else
	switch (id.id()) {
	case lc::controls::COLOUR_GAINS:
	case lc::controls::FRAME_DURATION_LIMITS:
		return 2;
	case lc::controls::SENSOR_BLACK_LEVELS:
		return 4;
	case lc::controls::COLOUR_CORRECTION_MATRIX:
		return 9;
	case lc::controls::AF_WINDOWS:
		return SIZE_MAX;
	default:
		return 0;
	}
#endif
}

/* The words for a control's values, where libcamera tells them. */
std::map<int32_t, std::string> control_words(const lc::ControlId &id)
{
#if LIBCAMERA_AT_LEAST(0, 4)
	return id.enumerators();
#else
	(void)id;
	return {};
#endif
}

/* The elements of a value as numbers; nothing when it is not of a type that has numbers. */
std::vector<double> numbers_of(const lc::ControlValue &value)
{
	const uint8_t *data = value.data().data();
	std::vector<double> numbers;

	const auto read = [&](auto zero) {
		for (size_t i = 0; i < value.numElements(); i++, data += sizeof(zero)) {
			memcpy(&zero, data, sizeof(zero));
			numbers.push_back((double)zero);
		}
	};
	switch (value.type()) {
	case lc::ControlTypeBool:
	case lc::ControlTypeByte:
		read(uint8_t());
		break;
	case lc::ControlTypeInteger32:
		read(int32_t());
		break;
	case lc::ControlTypeInteger64:
		read(int64_t());
		break;
	case lc::ControlTypeFloat:
		read(float());
		break;
	default:
		break;
	}
	return numbers;
}

std::string value_text(const lc::ControlValue &value)
{
	std::ostringstream text;

	text.precision(9);
	for (const double number : numbers_of(value)) {
		text << (text.tellp() > 0 ? " " : "");
		if (value.type() == lc::ControlTypeBool)
			text << (number != 0 ? "yes" : "no");
		else
			text << number;
	}
	return text.str().empty() ? value.toString() : text.str();
}

template <typename T> lc::ControlValue value_from(const std::vector<double> &numbers, bool array)
{
	const std::vector<T> elements(numbers.begin(), numbers.end());

	return array ? lc::ControlValue(lc::Span<const T>(elements.data(), elements.size()))
		     : lc::ControlValue(elements[0]);
}

lc::ControlValue value_of(lc::ControlType type, const std::vector<double> &numbers, bool array)
{
	switch (type) {
	case lc::ControlTypeBool:
		return lc::ControlValue(numbers[0] != 0);
	case lc::ControlTypeByte:
		return value_from<uint8_t>(numbers, array);
	case lc::ControlTypeInteger32:
		return value_from<int32_t>(numbers, array);
	case lc::ControlTypeInteger64:
		return value_from<int64_t>(numbers, array);
	default:
		return value_from<float>(numbers, array);
	}
}

/* What a number may be, whatever the camera says. */
void type_limits(lc::ControlType type, double *least, double *most)
{
	switch (type) {
	case lc::ControlTypeBool:
		*least = 0, *most = 1;
		return;
	case lc::ControlTypeByte:
		*least = 0, *most = UINT8_MAX;
		return;
	case lc::ControlTypeInteger32:
		*least = INT32_MIN, *most = INT32_MAX;
		return;
	case lc::ControlTypeInteger64: /* as far as doubles count one by one */
		*least = -0x1p53, *most = 0x1p53;
		return;
	case lc::ControlTypeFloat:
		*least = -std::numeric_limits<float>::max();
		*most = std::numeric_limits<float>::max();
		return;
	default:
		throw std::runtime_error("its kind cannot be set from a configuration");
	}
}

double number_of(const lc::ControlId &id, const std::string &text)
{
	static const char *const words[] = {"no", "yes", "false", "true", "off", "on"};
	char *end;

	for (int i = 0; i < 6; i++)
		if (id.type() == lc::ControlTypeBool && !strcasecmp(text.c_str(), words[i]))
			return i % 2;
	for (const auto &[number, word] : control_words(id))
		if (!strcasecmp(text.c_str(), word.c_str()))
			return number;
	const double value = strtod(text.c_str(), &end);
	if (*end || !std::isfinite(value))
		throw std::runtime_error("\"" + text + "\" is no value for it");
	if (id.type() != lc::ControlTypeFloat && value != std::floor(value))
		throw std::runtime_error("it takes whole numbers, not " + text);
	return value;
}

/* Throws a runtime_error that says why not. Arrays are written with blanks between. */
lc::ControlValue parse_value(const lc::ControlId &id, const lc::ControlInfo &info,
			     const std::string &text)
{
	const size_t elements = control_elements(id), expected = std::max<size_t>(elements, 1);
	const auto low = numbers_of(info.min()), high = numbers_of(info.max());
	std::vector<double> numbers;
	std::istringstream words(text);
	double least, most;

	type_limits(id.type(), &least, &most);
	for (std::string word; words >> word;) {
		const double number = number_of(id, word);
		const size_t i = numbers.size();

		/* Limits of an array may be those of each element; equal ones may mean "not
		 * known". */
		if (!low.empty() && !high.empty() && low.front() < high.front()) {
			least = low[std::min(i, low.size() - 1)];
			most = high[std::min(i, high.size() - 1)];
		}
		if (number < least || number > most)
			throw std::runtime_error(word + " is out of its range " +
						 value_text(info.min()) + ".." +
						 value_text(info.max()));
		numbers.push_back(number);
	}
	if (numbers.size() != expected)
		throw std::runtime_error(
			"expected " + std::to_string(expected) +
			(expected > 1 ? " values with blanks between, not " : " value, not ") +
			std::to_string(numbers.size()));
	return value_of(id.type(), numbers, elements > 0);
}

std::string trimmed(const std::string &text)
{
	const size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");

	return first == text.npos ? "" : text.substr(first, last - first + 1);
}

/* Sensors have steps: a line's time, a fraction of a gain. */
bool nearly_equal(const lc::ControlValue &a, const lc::ControlValue &b)
{
	const auto x = numbers_of(a), y = numbers_of(b);

	return x.size() == y.size() &&
	       std::equal(x.begin(), x.end(), y.begin(),
			  [](double p, double q) { return std::abs(p - q) <= 0.02 * std::abs(p); });
}

/* Controls take effect some frames after the request that carries them. */
constexpr int frames_to_settle = 12;

/* The controls that were asked for, and what became of each. */
class Wishes
{
      public:
	/* "name=value, name=value"; what cannot be is said and left out. */
	void parse(const std::string &camera, const lc::ControlInfoMap &known, const char *text)
	{
		std::istringstream list(text);

		camera_id = camera;
		for (std::string item; std::getline(list, item, ',');)
			if (!trimmed(item).empty())
				parse_item(known, item);
	}

	/* Both limits at once hold the rate; returns it, or 0: many cameras have no say in it. */
	double want_rate(const lc::ControlInfoMap &known, double rate_hz)
	{
		const auto limits = known.find(lc::controls::FRAME_DURATION_LIMITS);

		if (rate_hz <= 0 || limits == known.end())
			return 0;
		const auto low = numbers_of(limits->second.min());
		const auto high = numbers_of(limits->second.max());
		double wanted_us = std::round(1e6 / rate_hz);

		if (!low.empty() && !high.empty() && low.front() < high.front())
			wanted_us = std::clamp(wanted_us, low.front(), high.front());
		wishes.push_back({limits->first, value_of(lc::ControlTypeInteger64,
							  {wanted_us, wanted_us}, true)});
		return 1e6 / wanted_us;
	}

	/* What the next request carries: all of them at first, nothing later, and one at a time
	 * when the camera refused them together. */
	void put(lc::ControlList &controls)
	{
		for (; next < wishes.size(); next++) {
			controls.set(wishes[next].id->id(), wishes[next].value);
			if (alone) {
				next++;
				return;
			}
		}
	}

	/* A request came back undone with these controls. */
	void refused(const lc::ControlList &controls)
	{
		if (controls.size() > 1) {
			alone = true;
			next = 0;
		}
		for (const Wish &wish : wishes)
			if (controls.size() == 1 && controls.contains(wish.id->id()))
				log_warning("libcamera: %s: control %s: the camera refused %s",
					    camera_id.c_str(), wish.id->name().c_str(),
					    value_text(wish.value).c_str());
	}

	/* What the camera made of them: each that it reports is compared until it has settled. */
	void read_back(const lc::ControlList &metadata)
	{
		if (settling == 0 || wishes.empty())
			return;
		settling--;
		for (Wish &wish : wishes) {
			if (wish.granted || !metadata.contains(wish.id->id()))
				continue;
			const lc::ControlValue &given = metadata.get(wish.id->id());

			wish.granted = nearly_equal(wish.value, given);
			if (!wish.granted && settling == 0)
				log_warning("libcamera: %s: control %s: asked for %s, it uses %s",
					    camera_id.c_str(), wish.id->name().c_str(),
					    value_text(wish.value).c_str(),
					    value_text(given).c_str());
		}
	}

      private:
	struct Wish {
		const lc::ControlId *id;
		lc::ControlValue value;
		bool granted = false;
	};

	void parse_item(const lc::ControlInfoMap &known, const std::string &item)
	{
		const size_t sign = item.find('=');
		const std::string name = trimmed(item.substr(0, sign));
		const std::string value = sign == item.npos ? "" : item.substr(sign + 1);
		std::string refusal = "the camera has no such control";

		for (const auto &[id, info] : known) {
			if (strcasecmp(id->name().c_str(), name.c_str()))
				continue;
			try {
				wishes.push_back({id, parse_value(*id, info, value)});
				return;
			} catch (const std::runtime_error &why) {
				refusal = why.what();
			}
		}
		log_warning("libcamera: %s: control %s is not set: %s", camera_id.c_str(),
			    name.c_str(), refusal.c_str());
	}

	std::string camera_id;
	std::vector<Wish> wishes;
	size_t next = 0;
	bool alone = false;
	int settling = frames_to_settle;
};

/* ---- a camera that is open ---- */

/* What libcamera's thread leaves for ours: requests in the order in which they came back. */
class Inbox
{
      public:
	Inbox() : fd(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK))
	{
		if (fd < 0)
			throw Failure(-errno, "no event descriptor");
	}

	~Inbox()
	{
		close(fd);
	}

	Inbox(const Inbox &) = delete;
	Inbox &operator=(const Inbox &) = delete;

	/* Each request is in it at most once. */
	void make_room(size_t requests)
	{
		ring.resize(requests);
	}

	void completed(lc::Request *request)
	{
		const std::lock_guard<std::mutex> guard(lock);

		ring[(first + count++) % ring.size()] = (int)request->cookie();
		eventfd_write(fd, 1);
	}

	/* Nothing more will come. */
	void end()
	{
		const std::lock_guard<std::mutex> guard(lock);

		over = true;
		eventfd_write(fd, 1);
		changed.notify_all();
	}

	/* libcamera hears of a device that is gone a little later than we do, if at all. */
	bool ends_soon()
	{
		std::unique_lock<std::mutex> guard(lock);

		return changed.wait_for(guard, std::chrono::milliseconds(300),
					[this] { return over; });
	}

	bool ended()
	{
		const std::lock_guard<std::mutex> guard(lock);

		return over;
	}

	/* The oldest request, or -1. The descriptor is readable for as long as there is one. */
	int take()
	{
		const std::lock_guard<std::mutex> guard(lock);
		eventfd_t value;

		if (count == 0)
			return -1;
		const int index = ring[first];
		first = (first + 1) % ring.size();
		if (--count == 0 && !over)
			eventfd_read(fd, &value);
		return index;
	}

	const int fd;

      private:
	std::mutex lock;
	std::condition_variable changed;
	std::vector<int> ring;
	size_t first = 0, count = 0;
	bool over = false;
};

/* The names in /dev of what a camera is made of: of cameras other than webcams libcamera does not
 * tell that they are gone. */
class Nodes
{
      public:
	Nodes() : fd(inotify_init1(IN_CLOEXEC | IN_NONBLOCK))
	{
		if (fd < 0)
			throw Failure(-errno, "cannot watch /dev");
	}

	~Nodes()
	{
		close(fd);
	}

	Nodes(const Nodes &) = delete;
	Nodes &operator=(const Nodes &) = delete;

	void watch(const Manager &manager, const std::shared_ptr<lc::Camera> &camera)
	{
		const std::unique_ptr<DIR, int (*)(DIR *)> dev(opendir("/dev"), closedir);
		struct stat status;

		if (inotify_add_watch(fd, "/dev", IN_DELETE | IN_ONLYDIR) < 0)
			throw Failure(-errno, "cannot watch /dev");
		while (const dirent *entry = dev ? readdir(dev.get()) : nullptr)
			if (!strncmp(entry->d_name, "video", 5) &&
			    stat((std::string("/dev/") + entry->d_name).c_str(), &status) == 0 &&
			    manager.made_of(camera, status.st_rdev))
				names.push_back(entry->d_name);
	}

	/* Whether one of them was deleted since watch(). */
	bool deleted()
	{
		alignas(inotify_event) char events[4096];
		ssize_t length;

		while ((length = read(fd, events, sizeof(events))) > 0)
			for (const char *at = events; at < events + length;) {
				const auto *const event = (const inotify_event *)at;

				if (event->len > 0 && std::find(names.begin(), names.end(),
								event->name) != names.end())
					gone = true;
				at += sizeof(*event) + event->len;
			}
		return gone;
	}

	const int fd;

      private:
	std::vector<std::string> names;
	bool gone = false;
};

/* The memory behind one descriptor of libcamera's; several planes may share it. */
class Mapping
{
      public:
	explicit Mapping(int descriptor) : fd(descriptor)
	{
		const off_t end = lseek(fd, 0, SEEK_END);

		length = end > 0 ? (size_t)end : 0;
		memory = mmap(nullptr, length, PROT_READ, MAP_SHARED, fd, 0);
		if (memory == MAP_FAILED)
			throw Failure(-errno, "cannot map a buffer");
	}

	~Mapping()
	{
		if (memory != MAP_FAILED)
			munmap(memory, length);
	}

	Mapping(const Mapping &) = delete;
	Mapping &operator=(const Mapping &) = delete;

	/* Around what the processor reads, so that it does not read its cache's older picture.
	 * Memory that is no DMABUF needs none of it and says so. */
	void reading(bool begins) const
	{
		dma_buf_sync sync = {(__u64)(DMA_BUF_SYNC_READ |
					     (begins ? DMA_BUF_SYNC_START : DMA_BUF_SYNC_END))};

		while (ioctl(fd, DMA_BUF_IOCTL_SYNC, &sync) && (errno == EINTR || errno == EAGAIN))
			;
	}

	const uint8_t *data() const
	{
		return (const uint8_t *)memory;
	}

	const int fd;
	size_t length;

      private:
	void *memory;
};

struct Buffer {
	const lc::FrameBuffer *theirs = nullptr;
	std::list<Mapping> mappings; /* one a descriptor */
	frame_plane planes[FRAME_PLANES] = {};
};

/* From open() to the destructor, which cleans up however far open() came. */
class Session
{
      public:
	Session() = default;
	~Session();
	Session(const Session &) = delete;
	Session &operator=(const Session &) = delete;

	void open(camera *camera);
	int grab(camera *camera, frame *frame);
	void release(size_t index);

	/* False: the camera went away in a way that libcamera cannot clean up after: this session
	 * is to be left as it is. */
	bool can_be_deleted();

	/* Runs body; a failure says whose it is, once that is known. */
	template <typename Body> auto named(Body body)
	{
		try {
			return body();
		} catch (const Failure &why) {
			throw Failure(why.err, why.situation,
				      (id.empty() ? "" : id + ": ") + why.what());
		}
	}

	int descriptor() const
	{
		return poller;
	}

      private:
	void poll_both();
	void start(const camera_settings &settings);
	void map_buffers();
	void map_planes(Buffer &buffer) const;
	void queue(size_t index);
	void requeue(size_t index);
	bool read(size_t index, frame *frame);
	void read_metadata(camera *camera, lc::Request &request);
	uint32_t missed(uint32_t number);
	void reading(size_t index, bool begins) const;

	Manager manager; /* goes last */
	Inbox inbox;
	Nodes nodes;
	int poller = -1;
	std::string id;
	std::shared_ptr<lc::Camera> device;
	bool acquired = false;
	std::unique_ptr<lc::CameraConfiguration> configuration;
	std::unique_ptr<lc::FrameBufferAllocator> allocator;
	std::vector<Buffer> buffers;
	std::vector<std::unique_ptr<lc::Request>> requests; /* one a buffer */
	pixel_format format = PIXEL_NONE;
	colour_matrix matrix = MATRIX_BT601;
	colour_range range = RANGE_LIMITED;
	double rate_hz = 0; /* as far as it is known */
	int trouble = 0;    /* why a request was not taken */
	Wishes wishes;
	bool counted = false; /* last_number holds one */
	uint32_t last_number = 0;
};

Session::~Session()
{
	if (device) {
		/* From here on libcamera's thread does not call us. */
		device->stop();
		device->requestCompleted.disconnect(&inbox);
		device->disconnected.disconnect(&inbox);
	}
	requests.clear();
	buffers.clear();
	allocator.reset();
	configuration.reset();
	if (acquired)
		device->release();
	if (poller >= 0)
		close(poller);
}

bool Session::can_be_deleted()
{
	if (!nodes.deleted() || inbox.ends_soon())
		return true;
	buffers.clear();
	manager.forget(device);
	return false;
}

void Session::open(camera *camera)
{
	device = find(manager, camera->settings.device);
	id = device->id();
	const std::string model = model_of(*device);

	snprintf(camera->name, sizeof(camera->name), "%s", (model.empty() ? id : model).c_str());
	if (const int err = device->acquire(); err)
		throw Failure(err, "cannot take the camera, another program may use it");
	acquired = true;
	nodes.watch(manager, device);
	poll_both();
	configuration = configure(*device, camera->settings);
	const lc::StreamConfiguration &stream = configuration->at(0);

	format = format_of(stream.pixelFormat);
	matrix = matrix_of(stream, camera->settings.matrix);
	range = range_of(stream, camera->settings.range);
	start(camera->settings);
	camera->format = format;
	camera->width = (int)stream.size.width;
	camera->height = (int)stream.size.height;
	camera->rate_hz = rate_hz;
}

/* One descriptor for requests that came back and for nodes that went away. */
void Session::poll_both()
{
	epoll_event event = {};

	event.events = EPOLLIN;
	poller = epoll_create1(EPOLL_CLOEXEC);
	if (poller < 0 || epoll_ctl(poller, EPOLL_CTL_ADD, inbox.fd, &event) ||
	    epoll_ctl(poller, EPOLL_CTL_ADD, nodes.fd, &event))
		throw Failure(-errno, "no event descriptor");
}

void Session::start(const camera_settings &settings)
{
	map_buffers();
	wishes.parse(id, device->controls(), settings.controls);
	rate_hz = wishes.want_rate(device->controls(), settings.rate_hz);
	device->requestCompleted.connect(&inbox, &Inbox::completed);
	device->disconnected.connect(&inbox, &Inbox::end);
	if (const int err = device->start(); err)
		throw Failure(err, "cannot start the camera");
	wishes.put(requests[0]->controls());
	for (size_t i = 0; i < requests.size(); i++)
		queue(i);
}

void Session::map_buffers()
{
	lc::Stream *const stream = configuration->at(0).stream();

	allocator = std::make_unique<lc::FrameBufferAllocator>(device);
	if (const int count = allocator->allocate(stream); count < 2)
		throw Failure(count < 0 ? count : -ENOMEM, "cannot allocate two buffers");
	for (const auto &theirs : allocator->buffers(stream)) {
		auto request = device->createRequest(requests.size());

		if (!request || request->addBuffer(stream, theirs.get()))
			throw Failure(-ENOMEM, "cannot make a request");
		requests.push_back(std::move(request));
		buffers.emplace_back();
		buffers.back().theirs = theirs.get();
		map_planes(buffers.back());
	}
	inbox.make_room(requests.size());
}

/* Points our planes into the buffer. Where libcamera tells of one plane and we know of two, the
 * second follows the first. */
void Session::map_planes(Buffer &buffer) const
{
	const lc::StreamConfiguration &stream = configuration->at(0);
	const int height = (int)stream.size.height, width = (int)stream.size.width;
	const auto &theirs = buffer.theirs->planes();
	size_t rest = 0; /* of their last plane */

	for (int p = 0; p < (format == PIXEL_NV12 ? 2 : 1); p++) {
		frame_plane &plane = buffer.planes[p];
		const size_t rows = frame_plane_bytes(format, p, 1, height);
		const size_t row = frame_plane_stride(format, p, width);

		plane.stride = format == PIXEL_MJPEG ? 0 : stream.stride;
		if ((size_t)p < theirs.size()) {
			const int fd = theirs[p].fd.get();
			auto mapping = std::find_if(buffer.mappings.begin(), buffer.mappings.end(),
						    [fd](const Mapping &m) { return m.fd == fd; });

			if (mapping == buffer.mappings.end())
				mapping = buffer.mappings.emplace(buffer.mappings.end(), fd);
			const size_t offset = theirs[p].offset ==
							      lc::FrameBuffer::Plane::kInvalidOffset
						      ? 0
						      : theirs[p].offset;

			rest = offset < mapping->length ? std::min<size_t>(theirs[p].length,
									   mapping->length - offset)
							: 0;
			plane.data = mapping->data() + offset;
		} else {
			plane.data = buffer.planes[p - 1].data + plane.stride * (size_t)height;
		}
		plane.bytes = rest;
		if (format != PIXEL_MJPEG &&
		    (plane.stride < row || rest < plane.stride * (rows - 1) + row))
			throw Failure(-EINVAL, CAMERA_BROKEN,
				      "its buffers are smaller than a picture of " +
					      stream.toString());
		rest -= std::min(rest, plane.stride * (size_t)height);
	}
}

/* What fails here, the next grab() says. */
void Session::queue(size_t index)
{
	const int err = device->queueRequest(requests[index].get());

	if (err) {
		trouble = err;
		inbox.end();
	}
}

void Session::requeue(size_t index)
{
	lc::Request &request = *requests[index];

	request.reuse(lc::Request::ReuseBuffers);
	wishes.put(request.controls());
	queue(index);
}

void Session::release(size_t index)
{
	reading(index, false);
	requeue(index);
}

void Session::reading(size_t index, bool begins) const
{
	for (const Mapping &mapping : buffers[index].mappings)
		mapping.reading(begins);
}

/* Pipelines stamp frames with CLOCK_MONOTONIC, as V4L2 does, or with CLOCK_BOOTTIME, as libcamera's
 * documentation says: they differ by the time that was slept through. */
int64_t monotonic_ns(int64_t stamp_ns)
{
	const int64_t now_ns = clock_now_ns();
	timespec boot;

	if (stamp_ns > now_ns) {
		clock_gettime(CLOCK_BOOTTIME, &boot);
		stamp_ns -= (int64_t)boot.tv_sec * NS_PER_S + boot.tv_nsec - now_ns;
	}
	return stamp_ns > 0 && stamp_ns <= now_ns ? stamp_ns : now_ns;
}

/* False: cancelled, damaged, or not a whole picture. */
bool Session::read(size_t index, frame *frame)
{
	lc::Request &request = *requests[index];
	const Buffer &buffer = buffers[index];
	const lc::FrameMetadata &metadata = buffer.theirs->metadata();
	const auto stamp = request.metadata().get(lc::controls::SensorTimestamp);

	if (request.status() != lc::Request::RequestComplete ||
	    metadata.status == lc::FrameMetadata::FrameError ||
	    metadata.status == lc::FrameMetadata::FrameCancelled)
		return false;
	*frame = {};
	frame->format = format;
	frame->width = (int)configuration->at(0).size.width;
	frame->height = (int)configuration->at(0).size.height;
	frame->matrix = matrix;
	frame->range = range;
	frame->timestamp_ns = monotonic_ns(stamp ? *stamp : (int64_t)metadata.timestamp);
	frame->sequence = metadata.sequence;
	frame->buffer = (int)index;
	std::copy(std::begin(buffer.planes), std::end(buffer.planes), frame->planes);
	for (size_t p = 0; p < metadata.planes().size() && p < FRAME_PLANES; p++) {
		const size_t used = metadata.planes()[p].bytesused;
		frame_plane &plane = frame->planes[p];

		if (format == PIXEL_MJPEG)
			plane.bytes = std::min(plane.bytes, used);
		else if (used <
			 frame_plane_bytes(format, (int)p, plane.stride, frame->height) -
				 (plane.stride - frame_plane_stride(format, (int)p, frame->width)))
			return false;
	}
	return frame->planes[0].bytes > 0;
}

/* Numbers wrap; a step back means that the source counts anew. */
uint32_t Session::missed(uint32_t number)
{
	const uint32_t step = number - last_number;
	const bool gap = counted && step > 1 && step < UINT32_MAX / 2;

	counted = true;
	last_number = number;
	return gap ? step - 1 : 0;
}

void Session::read_metadata(camera *camera, lc::Request &request)
{
	const auto duration_us = request.metadata().get(lc::controls::FrameDuration);

	if (duration_us && *duration_us > 0)
		camera->rate_hz = 1e6 / (double)*duration_us;
	wishes.read_back(request.metadata());
}

int Session::grab(camera *camera, frame *frame)
{
	::frame newest = {}, next;

	if (inbox.ended() && trouble && trouble != -ENODEV)
		throw Failure(trouble, "it takes no request");
	if (inbox.ended() || nodes.deleted())
		throw Failure(-ENODEV, CAMERA_NO_DEVICE, "the camera has gone");
	/* Never more than there are, however fast the camera is. */
	for (size_t i = 0; i < requests.size(); i++) {
		const int index = inbox.take();

		if (index < 0)
			break;
		if (!read((size_t)index, &next)) {
			camera->broken++;
			wishes.refused(requests[(size_t)index]->controls());
			requeue((size_t)index);
			continue;
		}
		camera->lost += missed(next.sequence);
		read_metadata(camera, *requests[(size_t)index]);
		if (newest.format != PIXEL_NONE) {
			camera->lost++;
			requeue((size_t)newest.buffer);
		}
		newest = next;
	}
	if (newest.format == PIXEL_NONE)
		return -EAGAIN;
	reading((size_t)newest.buffer, true);
	*frame = newest;
	return 0;
}

/* ---- listing ---- */

struct Line {
	char text[sizeof(camera_listing::lines[0])];
};

class Listing
{
      public:
	explicit Listing(lc::Camera &camera) : device(camera)
	{
		add_formats();
		add_controls();
	}

	void show(void (*found)(void *, const camera_listing *), void *context)
	{
		camera_listing listing = {};

		snprintf(listing.device, sizeof(listing.device), "%s", device.id().c_str());
		snprintf(listing.name, sizeof(listing.name), "%s", model_of(device).c_str());
		listing.lines = &lines.data()->text;
		listing.line_count = (int)lines.size();
		found(context, &listing);
	}

      private:
	void add(const std::string &text)
	{
		lines.emplace_back();
		snprintf(lines.back().text, sizeof(lines.back().text), "%s", text.c_str());
	}

	void add_formats()
	{
		const auto configuration =
			device.generateConfiguration({lc::StreamRole::Viewfinder});

		if (!configuration || configuration->empty())
			return;
		const lc::StreamFormats &formats = configuration->at(0).formats();

		for (const lc::PixelFormat &format : formats.pixelformats()) {
			const pixel_format ours = format_of(format);
			const std::string name =
				format.toString() + " " +
				(ours ? pixel_format_names[ours] : "(not supported)") + " ";
			const lc::SizeRange sizes = formats.range(format);

			if (is_range(sizes)) {
				add(name + sizes.min.toString() + " to " + sizes.max.toString());
				continue;
			}
			for (const lc::Size &size : formats.sizes(format))
				add(name + size.toString());
		}
	}

	void add_controls()
	{
		std::vector<std::string> texts;

		for (const auto &[id, info] : device.controls()) {
			const auto words = control_words(*id);
			std::string text = "control \"" + id->name() + "\" ";

			if (info.values().empty())
				text += value_text(info.min()) + ".." + value_text(info.max());
			for (const lc::ControlValue &value : info.values()) {
				const auto number = numbers_of(value);
				const auto word = words.find(number.empty() ? -1 : (int)number[0]);

				text += (&value == info.values().data() ? "" : " | ") +
					(word == words.end() ? value_text(value) : word->second);
			}
			if (!info.def().isNone())
				text += ", default " + value_text(info.def());
			texts.push_back(text);
		}
		std::sort(texts.begin(), texts.end());
		for (const std::string &text : texts)
			add(text);
	}

	lc::Camera &device;
	std::vector<Line> lines;
};

/* ---- ops ---- */

/* No exception leaves this file. camera may be NULL. */
template <typename Body> int guarded(camera *camera, fault *fault, Body body) noexcept
{
	const char *const who = "libcamera";

	try {
		return body();
	} catch (const Failure &why) {
		if (camera)
			camera->situation = why.situation;
		return fault_say(fault, why.err, "%s: %s", who, why.what());
	} catch (const std::bad_alloc &) {
		return fault_say(fault, -ENOMEM, "%s: no memory", who);
	} catch (const std::exception &why) {
		return fault_say(fault, -EIO, "%s: %s", who, why.what());
	}
}

Session *session_of(const camera *camera)
{
	return static_cast<Session *>(camera->state);
}

int libcamera_list(void (*found)(void *, const camera_listing *), void *context)
{
	fault fault = {};
	const int count = guarded(nullptr, &fault, [&] {
		const Manager manager;
		const auto cameras = manager.cameras();

		for (const auto &device : cameras)
			Listing(*device).show(found, context);
		return (int)cameras.size();
	});

	if (count < 0)
		log_debug("%s", fault.text);
	return count == -ENODEV ? 0 : count;
}

int libcamera_open(camera *camera, fault *fault)
{
	return guarded(camera, fault, [&] {
		auto session = std::make_unique<Session>();

		session->named([&] { session->open(camera); });
		camera->state = session.release();
		return 0;
	});
}

int libcamera_descriptor(camera *camera)
{
	return session_of(camera)->descriptor();
}

int libcamera_grab(camera *camera, frame *frame, fault *fault)
{
	return guarded(camera, fault, [&] {
		Session &session = *session_of(camera);

		return session.named([&] { return session.grab(camera, frame); });
	});
}

void libcamera_release(camera *camera, frame *frame)
{
	guarded(nullptr, nullptr, [&] {
		session_of(camera)->release((size_t)frame->buffer);
		return 0;
	});
}

/*
 * libcamera aborts the program when it is asked to stop a camera that is gone, unless it knows so
 * by itself, as it does of webcams; and it does not survive that a running camera is destroyed.
 * What it holds for such a camera is left to it. That costs memory, some twenty descriptors and a
 * thread of libcamera's that is woken all the time, whenever a board's sensor is taken from under a
 * running program: a driver that is unbound.
 */
void libcamera_close(camera *camera)
{
	static std::vector<std::unique_ptr<Session>> *const left =
		new std::vector<std::unique_ptr<Session>>;
	static std::mutex lock;
	std::unique_ptr<Session> session(session_of(camera));

	camera->state = nullptr;
	guarded(nullptr, nullptr, [&] {
		if (session && !session->can_be_deleted()) {
			const std::lock_guard<std::mutex> guard(lock);

			left->push_back(std::move(session));
		}
		session.reset();
		return 0;
	});
}

constexpr camera_ops operations()
{
	camera_ops ops = {};

	ops.name = "libcamera";
	ops.description = "libcamera: sensors on a board's camera connector, and webcams";
	ops.list = libcamera_list;
	ops.open = libcamera_open;
	ops.descriptor = libcamera_descriptor;
	ops.grab = libcamera_grab;
	ops.release = libcamera_release;
	ops.close = libcamera_close;
	return ops;
}

} // namespace

extern "C" const camera_ops camera_libcamera = operations();
