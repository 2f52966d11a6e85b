/*
 * Cameras behind libcamera: sensors on a board's camera connector, whose picture the board's own
 * image processor makes.
 *
 * C++, because libcamera is: what speaks to it is in this file, the rest is C in libcamera/. Inside
 * this file a failure is an exception that says what the screen is to say; every op catches all of
 * them. Debian 12 has libcamera 0.0.3, Debian 13 0.4: what differs between them is in Manager,
 * elements_of() and number_of_word().
 */
#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <strings.h>

#include <libcamera/libcamera.h>

extern "C" {
#include "drivers/drivers.h"
#include "drivers/libcamera/controls.h"
#include "drivers/libcamera/events.h"
#include "drivers/libcamera/find.h"
#include "drivers/libcamera/hotplug.h"
#include "drivers/libcamera/messages.h"
#include "drivers/libcamera/picture.h"
#include "hal/camera_choice.h"
#include "hal/camera_situation.h"
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
	Failure(int code, const std::string &text) : Failure(code, text, camera_situation_of(code))
	{
	}

	Failure(int code, const std::string &text, camera_situation what)
	    : std::runtime_error(text), err(code), situation(what)
	{
	}

	const int err; /* negative errno */
	const camera_situation situation;
};

/* libcamera said err to what was tried. */
Failure refusal(int err, const std::string &tried)
{
	return {err, err == -ENOSPC ? "the bus has no room for its pictures: ask for a smaller "
				      "size or a lower rate"
				    : tried + ": " + strerror(-err)};
}

/* libcamera's own log, unless LIBCAMERA_LOG_FILE leads it elsewhere. */
class Messages : public std::streambuf
{
      protected:
	/* One call is one whole message, as libcamera writes them. */
	std::streamsize xsputn(const char *text, std::streamsize length) override
	{
		libcamera_message(text, (size_t)length);
		return length;
	}

	int overflow(int c) override
	{
		return c == EOF ? 0 : c;
	}
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
 * A process may have only one at a time: it lives as long as somebody holds one of these. It knows
 * the devices that there were when it began; for another, all who hold it let go of it. */
class Manager
{
      public:
	Manager()
	{
		const std::lock_guard<std::mutex> guard(lock);

		if (users > 0 && outdated)
			throw Failure(-ENODEV, "it is about to begin anew");
		if (users == 0) {
			redirect_messages();
			outdated = false;
			kept = libcamera_hotplug_kept();
			only = new lc::CameraManager;
			if (const int err = only->start(); err) {
				delete only;
				throw Failure(err, "it finds no devices at all", CAMERA_NO_DEVICE);
			}
		}
		users++;
	}

	~Manager()
	{
		const std::lock_guard<std::mutex> guard(lock);

		if (--users > 0)
			return;
		delete only; /* which stops it */
	}

	Manager(const Manager &) = delete;
	Manager &operator=(const Manager &) = delete;

	std::vector<std::shared_ptr<lc::Camera>> cameras() const
	{
		return only->cameras();
	}

	/* What is looked for may be among the devices that came since it began. */
	void want_others() const
	{
		const std::lock_guard<std::mutex> guard(lock);

		if (outdated || users == 1 || kept == libcamera_hotplug_kept())
			return;
		outdated = true;
		log_info("libcamera: it begins anew, as devices were plugged in");
	}

	bool is_outdated() const
	{
		const std::lock_guard<std::mutex> guard(lock);

		return outdated;
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
	static unsigned kept; /* libcamera_hotplug_kept() when it began */
	static bool outdated;
};

std::mutex Manager::lock;
lc::CameraManager *Manager::only;
int Manager::users;
unsigned Manager::kept;
bool Manager::outdated;

std::string model_of(const lc::Camera &device)
{
	const auto model = device.properties().get(lc::properties::Model);

	return model ? std::string(*model) : std::string();
}

std::shared_ptr<lc::Camera> find(const Manager &manager, const char *wanted)
{
	const auto cameras = manager.cameras();
	std::deque<std::string> models;
	std::vector<libcamera_name> names;
	fault why;

	for (const auto &device : cameras)
		names.push_back(
			{device->id().c_str(), models.emplace_back(model_of(*device)).c_str()});
	const int index = libcamera_find(names.data(), (int)names.size(), wanted, &why);

	if (index < 0) {
		manager.want_others();
		throw Failure(index, why.text);
	}
	return cameras[(size_t)index];
}

/* ---- pictures ----
 * libcamera names formats as DRM does, from the most significant byte of a word; we name them in
 * the order of memory. Of two for one format the first is taken. */
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

/* The formats to try, best first. A camera that does not tell its formats is asked for each of
 * ours. */
std::vector<Layout> candidates(const lc::StreamFormats &formats, int wanted, lc::Size size)
{
	const auto offered = formats.pixelformats();
	std::vector<Layout> found;

	const auto merit = [&](const Layout &layout) {
		return camera_format_merit(layout.ours, offers_size(formats, layout.theirs, size),
					   false);
	};
	for (const Layout &layout : layouts)
		if ((wanted == PIXEL_NONE || layout.ours == wanted) &&
		    (offered.empty() ||
		     std::find(offered.begin(), offered.end(), layout.theirs) != offered.end()))
			found.push_back(layout);
	std::stable_sort(found.begin(), found.end(),
			 [&](const Layout &a, const Layout &b) { return merit(a) > merit(b); });
	return found;
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
		throw Failure(-ENOTSUP, "it offers no stream", CAMERA_UNSUPPORTED_FORMAT);
	lc::StreamConfiguration &stream = configuration->at(0);
	const lc::StreamFormats formats = stream.formats();
	const lc::Size size(settings.width ? (unsigned)settings.width : stream.size.width,
			    settings.height ? (unsigned)settings.height : stream.size.height);

	for (const Layout &layout : candidates(formats, settings.format, size)) {
		stream.pixelFormat = layout.theirs;
		stream.size = size;
		stream.stride = 0;
		stream.bufferCount = (unsigned)settings.buffers;
		if (configuration->validate() == lc::CameraConfiguration::Invalid ||
		    stream.pixelFormat != layout.theirs)
			continue;
		if (settings.width && settings.height && stream.size != size)
			log_info("libcamera: %s: asked for %dx%d, it gives %ux%u",
				 device.id().c_str(), settings.width, settings.height,
				 stream.size.width, stream.size.height);
		if (const int err = device.configure(configuration.get()); err)
			throw refusal(err, "cannot set " + stream.toString());
		return configuration;
	}
	throw Failure(-ENOTSUP,
		      "it offers " + offered_text(formats) + ", expected " +
			      (settings.format ? pixel_format_names[settings.format]
					       : "a format that inlay decodes"),
		      CAMERA_UNSUPPORTED_FORMAT);
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

/* Of an array; 0: a single value. */
size_t elements_of(const lc::ControlId &id)
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
std::map<int32_t, std::string> words_of(const lc::ControlId &id)
{
#if LIBCAMERA_AT_LEAST(0, 4)
	return id.enumerators();
#else
	(void)id;
	return {};
#endif
}

bool number_of_word(const void *theirs, const char *word, double *number) noexcept
{
	for (const auto &[value, known] : words_of(*static_cast<const lc::ControlId *>(theirs)))
		if (!strcasecmp(known.c_str(), word)) {
			*number = value;
			return true;
		}
	return false;
}

libcamera_kind kind_of(lc::ControlType type)
{
	switch (type) {
	case lc::ControlTypeBool:
		return LIBCAMERA_BOOL;
	case lc::ControlTypeByte:
		return LIBCAMERA_BYTE;
	case lc::ControlTypeInteger32:
		return LIBCAMERA_INT32;
	case lc::ControlTypeInteger64:
		return LIBCAMERA_INT64;
	case lc::ControlTypeFloat:
		return LIBCAMERA_FLOAT;
	default:
		return LIBCAMERA_OTHER;
	}
}

libcamera_value numbers_of(const lc::ControlValue &value)
{
	libcamera_value numbers;

	libcamera_value_unpack(&numbers, kind_of(value.type()), (int)value.numElements(),
			       value.data().data());
	return numbers;
}

lc::ControlValue value_of(const libcamera_wish &wish)
{
	const auto *const id = static_cast<const lc::ControlId *>(wish.control->theirs);
	lc::ControlValue value;

	value.reserve(id->type(), wish.control->elements > 0, (size_t)wish.value.count);
	libcamera_value_pack(&wish.value, value.data().data());
	return value;
}

/* What the next request is to carry. */
libcamera_load put_wishes(libcamera_wishes &wishes, lc::ControlList &controls)
{
	const libcamera_load load = libcamera_wishes_next(&wishes);

	for (int i = load.first; i < load.first + load.count; i++) {
		const libcamera_wish &wish = wishes.list[i];

		controls.set(static_cast<const lc::ControlId *>(wish.control->theirs)->id(),
			     value_of(wish));
	}
	return load;
}

std::vector<libcamera_control> controls_of(const lc::ControlInfoMap &known)
{
	std::vector<libcamera_control> controls;

	for (const auto &[id, info] : known) {
		libcamera_control control = {};

		control.theirs = id;
		snprintf(control.name, sizeof(control.name), "%s", id->name().c_str());
		control.kind = kind_of(id->type());
		control.elements = (int)std::min<size_t>(elements_of(*id), INT_MAX);
		control.least = numbers_of(info.min());
		control.most = numbers_of(info.max());
		control.number_of = number_of_word;
		controls.push_back(control);
	}
	return controls;
}

/* What the camera used for a control. */
bool used_value(const void *metadata, const void *theirs, libcamera_value *value) noexcept
{
	const auto &list = *static_cast<const lc::ControlList *>(metadata);
	const unsigned id = static_cast<const lc::ControlId *>(theirs)->id();

	if (!list.contains(id))
		return false;
	*value = numbers_of(list.get(id));
	return true;
}

/* ---- a camera that is open ---- */

/* A buffer and the request that it goes around with. */
struct Slot {
	std::unique_ptr<lc::Request> request;
	const lc::FrameBuffer *buffer;
	libcamera_picture picture;
	libcamera_load load; /* the controls that the request carries */
};

/* From open() to the destructor, which cleans up however far open() came. */
class Session
{
      public:
	Session()
	{
		fault why;

		if (const int err = libcamera_events_open(&events, &why); err)
			throw Failure(err, why.text);
	}

	~Session()
	{
		if (device) {
			/* From here on libcamera's thread does not call us. */
			device->stop();
			device->requestCompleted.disconnect(this);
			device->disconnected.disconnect(this);
		}
		unmap();
		slots.clear();
		allocator.reset();
		configuration.reset();
		if (acquired)
			device->release();
		libcamera_events_close(&events);
	}

	Session(const Session &) = delete;
	Session &operator=(const Session &) = delete;

	void open(camera *camera)
	{
		device = find(*manager, camera->settings.device);
		id = device->id();
		const std::string model = model_of(*device);

		snprintf(camera->name, sizeof(camera->name), "%s",
			 (model.empty() ? id : model).c_str());
		if (const int err = device->acquire(); err)
			throw refusal(err, "cannot take the camera, another program may use it");
		acquired = true;
		watch();
		configuration = configure(*device, camera->settings);
		const lc::StreamConfiguration &stream = configuration->at(0);

		blank.format = camera->format = format_of(stream.pixelFormat);
		blank.width = camera->width = (int)stream.size.width;
		blank.height = camera->height = (int)stream.size.height;
		blank.matrix = matrix_of(stream, camera->settings.matrix);
		blank.range = range_of(stream, camera->settings.range);
		make_slots(stream);
		controls = controls_of(device->controls());
		camera->rate_hz = libcamera_wishes_read(
			&wishes, id.c_str(), controls.data(), (int)controls.size(),
			camera->settings.controls, camera->settings.rate_hz);
		start();
	}

	int descriptor() const
	{
		return events.descriptor;
	}

	int control(const char *name, const char *value, fault *fault)
	{
		::fault why;

		if (const int err = libcamera_wishes_change(
			    &wishes, controls.data(), (int)controls.size(), name, value, &why);
		    err)
			return fault_say(fault, err, "libcamera: %s: %s", id.c_str(), why.text);
		return 0;
	}

	int grab(camera *camera, frame *frame)
	{
		::frame newest = {}, next;
		int index = -EAGAIN;

		if (libcamera_events_deleted(&events))
			throw Failure(-ENODEV, "the camera has gone");
		if (manager->is_outdated())
			throw Failure(-ESTALE, "libcamera begins anew", CAMERA_FINE);
		/* Never more than there are, however fast the camera is. */
		for (size_t i = 0; i < slots.size(); i++) {
			index = libcamera_events_take(&events);
			if (index < 0)
				break;
			Slot &slot = slots[(size_t)index];

			if (!read(slot, &next)) {
				camera->broken++;
				libcamera_wishes_refused(&wishes, slot.load);
				requeue(slot);
				continue;
			}
			camera->lost += missed(next.sequence);
			read_metadata(camera, slot.request->metadata());
			if (newest.format != PIXEL_NONE) {
				camera->lost++;
				requeue(slots[(size_t)newest.buffer]);
			}
			newest = next;
		}
		if (index == -ENODEV)
			throw trouble && trouble != -ENODEV
				? refusal(trouble, "it takes no request")
				: Failure(-ENODEV, "the camera has gone");
		if (newest.format == PIXEL_NONE)
			return -EAGAIN;
		libcamera_picture_reading(&slots[(size_t)newest.buffer].picture, true);
		*frame = newest;
		return 0;
	}

	void release(size_t index)
	{
		libcamera_picture_reading(&slots[index].picture, false);
		requeue(slots[index]);
	}

	/* False: the camera went away in a way that libcamera cannot clean up after: this session
	 * is to be left as it is, but for its hold on the manager. */
	bool can_be_deleted()
	{
		if (!libcamera_events_deleted(&events) || libcamera_events_end_soon(&events))
			return true;
		unmap();
		manager->forget(device);
		manager.reset();
		return false;
	}

	std::string id; /* of the camera, once that is known */

      private:
	void watch()
	{
		const auto own = [](const void *session, dev_t number) {
			const auto *const self = static_cast<const Session *>(session);

			return self->manager->made_of(self->device, number);
		};
		fault why;

		if (const int err = libcamera_events_watch(&events, own, this, &why); err)
			throw Failure(err, why.text);
	}

	void make_slots(const lc::StreamConfiguration &stream)
	{
		allocator = std::make_unique<lc::FrameBufferAllocator>(device);
		if (const int count = allocator->allocate(stream.stream()); count < 2)
			throw refusal(count < 0 ? count : -ENOMEM, "cannot allocate two buffers");
		for (const auto &buffer : allocator->buffers(stream.stream())) {
			if (slots.size() == LIBCAMERA_REQUESTS_MAX)
				break;
			auto request = device->createRequest(slots.size());

			if (!request || request->addBuffer(stream.stream(), buffer.get()))
				throw refusal(-ENOMEM, "cannot make a request");
			slots.push_back({std::move(request), buffer.get(), {}, {}});
			map(slots.back(), stream);
		}
	}

	void map(Slot &slot, const lc::StreamConfiguration &stream) const
	{
		libcamera_span spans[FRAME_PLANES];
		int count = 0;

		for (const auto &plane : slot.buffer->planes())
			if (count < FRAME_PLANES)
				spans[count++] = {
					plane.fd.get(),
					plane.offset == lc::FrameBuffer::Plane::kInvalidOffset
						? 0
						: plane.offset,
					plane.length};
		slot.picture.format = blank.format;
		slot.picture.width = blank.width;
		slot.picture.height = blank.height;
		const int err = libcamera_picture_map(&slot.picture, stream.stride, spans, count);

		if (err == -EINVAL)
			throw Failure(err, "its buffers are smaller than a picture of " +
						   stream.toString());
		if (err)
			throw refusal(err, "cannot map a buffer");
	}

	void unmap()
	{
		for (Slot &slot : slots)
			libcamera_picture_unmap(&slot.picture);
	}

	/* What is connected here runs on libcamera's thread. */
	void start()
	{
		device->requestCompleted.connect(this, [this](lc::Request *request) {
			libcamera_events_done(&events, (int)request->cookie());
		});
		device->disconnected.connect(this, [this] { libcamera_events_end(&events); });
		if (const int err = device->start(); err)
			throw refusal(err, "cannot start the camera");
		for (Slot &slot : slots)
			queue(slot);
	}

	/* What fails here, the next grab() says. */
	void queue(Slot &slot)
	{
		slot.load = put_wishes(wishes, slot.request->controls());
		if (const int err = device->queueRequest(slot.request.get()); err) {
			trouble = err;
			libcamera_events_end(&events);
		}
	}

	void requeue(Slot &slot)
	{
		slot.request->reuse(lc::Request::ReuseBuffers);
		queue(slot);
	}

	/* False: cancelled, damaged, or not a whole picture. */
	bool read(const Slot &slot, frame *frame) const
	{
		const lc::FrameMetadata &metadata = slot.buffer->metadata();
		const auto stamp = slot.request->metadata().get(lc::controls::SensorTimestamp);
		size_t used[FRAME_PLANES];
		int count = 0;

		if (slot.request->status() != lc::Request::RequestComplete ||
		    metadata.status == lc::FrameMetadata::FrameError ||
		    metadata.status == lc::FrameMetadata::FrameCancelled)
			return false;
		*frame = blank;
		frame->timestamp_ns =
			libcamera_picture_time_ns(stamp ? *stamp : (int64_t)metadata.timestamp);
		frame->sequence = metadata.sequence;
		frame->buffer = (int)slot.request->cookie();
		for (const auto &plane : metadata.planes())
			if (count < FRAME_PLANES)
				used[count++] = plane.bytesused;
		return libcamera_picture_planes(&slot.picture, used, count, frame->planes);
	}

	/* Numbers wrap; a step back means that the source counts anew. */
	uint32_t missed(uint32_t number)
	{
		const uint32_t step = number - last_number;
		const bool gap = counted && step > 1 && step < UINT32_MAX / 2;

		counted = true;
		last_number = number;
		return gap ? step - 1 : 0;
	}

	void read_metadata(camera *camera, const lc::ControlList &metadata)
	{
		const auto duration_us = metadata.get(lc::controls::FrameDuration);

		if (duration_us && *duration_us > 0)
			camera->rate_hz = 1e6 / (double)*duration_us;
		libcamera_wishes_compare(&wishes, used_value, &metadata);
	}

	std::optional<Manager> manager = std::make_optional<Manager>(); /* goes last */
	libcamera_events events;
	std::shared_ptr<lc::Camera> device;
	bool acquired = false;
	std::unique_ptr<lc::CameraConfiguration> configuration;
	std::unique_ptr<lc::FrameBufferAllocator> allocator;
	std::deque<Slot> slots; /* a request's cookie is its index */
	frame blank = {};	/* what all frames have in common */
	std::vector<libcamera_control> controls;
	libcamera_wishes wishes = {};
	int trouble = 0;      /* why a request was not taken */
	bool counted = false; /* last_number holds one */
	uint32_t last_number = 0;
};

/* ---- listing ---- */

std::string value_text(const lc::ControlValue &value)
{
	const libcamera_value numbers = numbers_of(value);
	char text[LIBCAMERA_VALUE_TEXT_MAX];

	libcamera_value_text(&numbers, text);
	return numbers.count > 0 ? text : value.toString();
}

std::vector<std::string> format_lines(lc::Camera &device)
{
	const auto configuration = device.generateConfiguration({lc::StreamRole::Viewfinder});
	std::vector<std::string> lines;

	if (!configuration || configuration->empty())
		return lines;
	const lc::StreamFormats &formats = configuration->at(0).formats();

	for (const lc::PixelFormat &format : formats.pixelformats()) {
		const pixel_format ours = format_of(format);
		const std::string name = format.toString() + " " +
					 (ours ? pixel_format_names[ours] : "(not supported)") +
					 " ";
		const lc::SizeRange sizes = formats.range(format);

		if (is_range(sizes)) {
			lines.push_back(name + sizes.min.toString() + " to " +
					sizes.max.toString());
			continue;
		}
		for (const lc::Size &size : formats.sizes(format))
			lines.push_back(name + size.toString());
	}
	return lines;
}

std::vector<std::string> control_lines(const lc::Camera &device)
{
	std::vector<std::string> lines;

	for (const auto &[id, info] : device.controls()) {
		const auto words = words_of(*id);
		std::string text = "control \"" + id->name() + "\" ";

		if (info.values().empty())
			text += value_text(info.min()) + ".." + value_text(info.max());
		for (const lc::ControlValue &value : info.values()) {
			const libcamera_value number = numbers_of(value);
			const auto word = words.find(number.count ? (int)number.numbers[0] : -1);

			text += (&value == info.values().data() ? "" : " | ") +
				(word == words.end() ? value_text(value) : word->second);
		}
		if (!info.def().isNone())
			text += ", default " + value_text(info.def());
		lines.push_back(text);
	}
	std::sort(lines.begin(), lines.end());
	return lines;
}

void show(lc::Camera &device, void (*found)(void *, const camera_listing *), void *context)
{
	struct Line {
		char text[sizeof(camera_listing::lines[0])];
	};
	std::vector<std::string> texts = format_lines(device);
	const std::vector<std::string> more = control_lines(device);
	camera_listing listing = {};

	texts.insert(texts.end(), more.begin(), more.end());
	std::vector<Line> lines(texts.size());

	for (size_t i = 0; i < texts.size(); i++)
		snprintf(lines[i].text, sizeof(lines[i].text), "%s", texts[i].c_str());
	snprintf(listing.device, sizeof(listing.device), "%s", device.id().c_str());
	snprintf(listing.name, sizeof(listing.name), "%s", model_of(device).c_str());
	listing.lines = &lines.data()->text;
	listing.line_count = (int)lines.size();
	found(context, &listing);
}

/* ---- ops ---- */

Session *session_of(const camera *camera)
{
	return static_cast<Session *>(camera->state);
}

/* No exception leaves this file. A failure says whose it is, once that is known; camera may be
 * NULL. */
template <typename Body> int guarded(camera *camera, fault *fault, Body body) noexcept
{
	try {
		return body();
	} catch (const Failure &why) {
		const Session *const session = camera ? session_of(camera) : nullptr;
		const char *const id = session ? session->id.c_str() : "";

		if (camera)
			camera->situation = why.situation;
		return fault_say(fault, why.err, "libcamera: %s%s%s", id, *id ? ": " : "",
				 why.what());
	} catch (const std::bad_alloc &) {
		return fault_say(fault, -ENOMEM, "libcamera: no memory");
	} catch (const std::exception &why) {
		return fault_say(fault, -EIO, "libcamera: %s", why.what());
	}
}

int libcamera_list(void (*found)(void *, const camera_listing *), void *context)
{
	fault fault = {};
	const int count = guarded(nullptr, &fault, [&] {
		const Manager manager;
		const auto cameras = manager.cameras();

		for (const auto &device : cameras)
			show(*device, found, context);
		return (int)cameras.size();
	});

	if (count < 0)
		log_debug("%s", fault.text);
	return count == -ENODEV ? 0 : count;
}

/* What a failure leaves, close() cleans up. */
int libcamera_open(camera *camera, fault *fault)
{
	return guarded(camera, fault, [&] {
		camera->state = new Session;
		session_of(camera)->open(camera);
		return 0;
	});
}

int libcamera_descriptor(camera *camera)
{
	return session_of(camera)->descriptor();
}

int libcamera_grab(camera *camera, frame *frame, fault *fault)
{
	return guarded(camera, fault, [&] { return session_of(camera)->grab(camera, frame); });
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
 * What it holds for such a camera is left to it. That costs memory and some twenty descriptors
 * (and, while another camera is open, a thread of libcamera's that is woken all the time), whenever
 * a board's sensor is taken from under a running program: a driver that is unbound.
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

int libcamera_control_change(camera *camera, const char *name, const char *value, fault *fault)
{
	return guarded(nullptr, fault,
		       [&] { return session_of(camera)->control(name, value, fault); });
}

} // namespace

/* In the order of the struct; it has no keys of its own. */
extern "C" const camera_ops camera_libcamera = {
	"libcamera",
	"libcamera: sensors on a board's camera connector, and webcams",
	nullptr,
	0,
	libcamera_list,
	libcamera_open,
	libcamera_descriptor,
	libcamera_grab,
	libcamera_release,
	libcamera_close,
	libcamera_control_change,
};
