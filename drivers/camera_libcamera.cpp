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
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <strings.h>

#include <libcamera/libcamera.h>

extern "C" {
#include "drivers/drivers.h"
#include "drivers/libcamera/absence.h"
#include "drivers/libcamera/controls.h"
#include "drivers/libcamera/events.h"
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

	if (cameras.empty()) {
		fault why;
		const int err = libcamera_absence(&why);

		throw Failure(err, why.text);
	}
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
			throw Failure(-EINVAL,
				      "\"" + wanted +
					      "\" fits more than one camera, expected one of " +
					      names_of(found));
	}
	throw Failure(-ENODEV, "no camera \"" + wanted + "\"; there is " + names_of(cameras));
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
	const uint8_t *data = value.data().data();
	libcamera_value numbers = {};

	const auto read = [&](auto zero) {
		numbers.count = (int)std::min<size_t>(value.numElements(), LIBCAMERA_NUMBERS_MAX);
		for (int i = 0; i < numbers.count; i++, data += sizeof(zero)) {
			memcpy(&zero, data, sizeof(zero));
			numbers.numbers[i] = (double)zero;
		}
	};
	numbers.kind = kind_of(value.type());
	switch (numbers.kind) {
	case LIBCAMERA_BOOL:
	case LIBCAMERA_BYTE:
		read(uint8_t());
		break;
	case LIBCAMERA_INT32:
		read(int32_t());
		break;
	case LIBCAMERA_INT64:
		read(int64_t());
		break;
	case LIBCAMERA_FLOAT:
		read(float());
		break;
	case LIBCAMERA_OTHER:
		break;
	}
	return numbers;
}

template <typename T> lc::ControlValue value_from(const libcamera_value &numbers, bool array)
{
	const std::vector<T> elements(numbers.numbers, numbers.numbers + numbers.count);

	return array ? lc::ControlValue(lc::Span<const T>(elements.data(), elements.size()))
		     : lc::ControlValue(elements[0]);
}

lc::ControlValue value_of(const libcamera_wish &wish)
{
	const bool array = wish.control->elements > 0;

	switch (wish.control->kind) {
	case LIBCAMERA_BOOL:
		return lc::ControlValue(wish.value.numbers[0] != 0);
	case LIBCAMERA_BYTE:
		return value_from<uint8_t>(wish.value, array);
	case LIBCAMERA_INT32:
		return value_from<int32_t>(wish.value, array);
	case LIBCAMERA_INT64:
		return value_from<int64_t>(wish.value, array);
	default:
		return value_from<float>(wish.value, array);
	}
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
	Slot() = default;

	~Slot()
	{
		libcamera_picture_unmap(&picture);
	}

	Slot(const Slot &) = delete;
	Slot &operator=(const Slot &) = delete;

	std::unique_ptr<lc::Request> request;
	const lc::FrameBuffer *buffer = nullptr;
	libcamera_picture picture = {};
	libcamera_load load = {}; /* the controls that the request carries */
};

/* From open() to the destructor, which cleans up however far open() came. */
class Session
{
      public:
	Session();
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
			throw Failure(why.err, (id.empty() ? "" : id + ": ") + why.what(),
				      why.situation);
		}
	}

	int descriptor() const
	{
		return events.descriptor;
	}

      private:
	/* libcamera's thread calls these two. */
	void completed(lc::Request *request);
	void disconnected();

	static bool owns(const void *session, dev_t number) noexcept;
	void start(const camera_settings &settings);
	void make_slots();
	void map(Slot &slot) const;
	void queue(Slot &slot);
	void requeue(Slot &slot);
	bool read(const Slot &slot, frame *frame) const;
	void read_metadata(camera *camera, const lc::ControlList &metadata);
	uint32_t missed(uint32_t number);

	Manager manager; /* goes last */
	libcamera_events events;
	std::string id;
	std::shared_ptr<lc::Camera> device;
	bool acquired = false;
	std::unique_ptr<lc::CameraConfiguration> configuration;
	std::unique_ptr<lc::FrameBufferAllocator> allocator;
	std::deque<Slot> slots; /* a request's cookie is its index */
	colour_matrix matrix = MATRIX_BT601;
	colour_range range = RANGE_LIMITED;
	std::vector<libcamera_control> controls;
	libcamera_wishes wishes = {};
	double rate_hz = 0;   /* as far as it is known */
	int trouble = 0;      /* why a request was not taken */
	bool counted = false; /* last_number holds one */
	uint32_t last_number = 0;
};

Session::Session()
{
	fault why;

	if (const int err = libcamera_events_open(&events, &why); err)
		throw Failure(err, why.text);
}

Session::~Session()
{
	if (device) {
		/* From here on libcamera's thread does not call us. */
		device->stop();
		device->requestCompleted.disconnect(this);
		device->disconnected.disconnect(this);
	}
	slots.clear();
	allocator.reset();
	configuration.reset();
	if (acquired)
		device->release();
	libcamera_events_close(&events);
}

bool Session::can_be_deleted()
{
	if (!libcamera_events_deleted(&events) || libcamera_events_end_soon(&events))
		return true;
	for (Slot &slot : slots)
		libcamera_picture_unmap(&slot.picture);
	manager.forget(device);
	return false;
}

void Session::completed(lc::Request *request)
{
	libcamera_events_done(&events, (int)request->cookie());
}

void Session::disconnected()
{
	libcamera_events_end(&events);
}

bool Session::owns(const void *session, dev_t number) noexcept
{
	const auto *const self = static_cast<const Session *>(session);

	return self->manager.made_of(self->device, number);
}

void Session::open(camera *camera)
{
	fault why;

	device = find(manager, camera->settings.device);
	id = device->id();
	const std::string model = model_of(*device);

	snprintf(camera->name, sizeof(camera->name), "%s", (model.empty() ? id : model).c_str());
	if (const int err = device->acquire(); err)
		throw refusal(err, "cannot take the camera, another program may use it");
	acquired = true;
	if (const int err = libcamera_events_watch(&events, owns, this, &why); err)
		throw Failure(err, why.text);
	configuration = configure(*device, camera->settings);
	const lc::StreamConfiguration &stream = configuration->at(0);

	matrix = matrix_of(stream, camera->settings.matrix);
	range = range_of(stream, camera->settings.range);
	start(camera->settings);
	camera->format = format_of(stream.pixelFormat);
	camera->width = (int)stream.size.width;
	camera->height = (int)stream.size.height;
	camera->rate_hz = rate_hz;
}

void Session::start(const camera_settings &settings)
{
	make_slots();
	controls = controls_of(device->controls());
	rate_hz = libcamera_wishes_read(&wishes, id.c_str(), controls.data(), (int)controls.size(),
					settings.controls, settings.rate_hz);
	device->requestCompleted.connect(this, &Session::completed);
	device->disconnected.connect(this, &Session::disconnected);
	if (const int err = device->start(); err)
		throw refusal(err, "cannot start the camera");
	for (Slot &slot : slots)
		queue(slot);
}

void Session::make_slots()
{
	lc::Stream *const stream = configuration->at(0).stream();

	allocator = std::make_unique<lc::FrameBufferAllocator>(device);
	if (const int count = allocator->allocate(stream); count < 2)
		throw refusal(count < 0 ? count : -ENOMEM, "cannot allocate two buffers");
	for (const auto &buffer : allocator->buffers(stream)) {
		if (slots.size() == LIBCAMERA_REQUESTS_MAX)
			break;
		auto request = device->createRequest(slots.size());

		if (!request || request->addBuffer(stream, buffer.get()))
			throw refusal(-ENOMEM, "cannot make a request");
		Slot &slot = slots.emplace_back();

		slot.request = std::move(request);
		slot.buffer = buffer.get();
		map(slot);
	}
}

void Session::map(Slot &slot) const
{
	const lc::StreamConfiguration &stream = configuration->at(0);
	libcamera_span spans[FRAME_PLANES];
	int count = 0;

	for (const auto &plane : slot.buffer->planes())
		if (count < FRAME_PLANES)
			spans[count++] = {plane.fd.get(),
					  plane.offset == lc::FrameBuffer::Plane::kInvalidOffset
						  ? 0
						  : plane.offset,
					  plane.length};
	slot.picture.format = format_of(stream.pixelFormat);
	slot.picture.width = (int)stream.size.width;
	slot.picture.height = (int)stream.size.height;
	const int err = libcamera_picture_map(&slot.picture, stream.stride, spans, count);

	if (err == -EINVAL)
		throw Failure(err,
			      "its buffers are smaller than a picture of " + stream.toString());
	if (err)
		throw refusal(err, "cannot map a buffer");
}

/* What fails here, the next grab() says. */
void Session::queue(Slot &slot)
{
	slot.load = put_wishes(wishes, slot.request->controls());
	if (const int err = device->queueRequest(slot.request.get()); err) {
		trouble = err;
		libcamera_events_end(&events);
	}
}

void Session::requeue(Slot &slot)
{
	slot.request->reuse(lc::Request::ReuseBuffers);
	queue(slot);
}

void Session::release(size_t index)
{
	libcamera_picture_reading(&slots[index].picture, false);
	requeue(slots[index]);
}

/* False: cancelled, damaged, or not a whole picture. */
bool Session::read(const Slot &slot, frame *frame) const
{
	const lc::FrameMetadata &metadata = slot.buffer->metadata();
	const auto stamp = slot.request->metadata().get(lc::controls::SensorTimestamp);
	size_t used[FRAME_PLANES];
	int count = 0;

	if (slot.request->status() != lc::Request::RequestComplete ||
	    metadata.status == lc::FrameMetadata::FrameError ||
	    metadata.status == lc::FrameMetadata::FrameCancelled)
		return false;
	*frame = {};
	frame->format = slot.picture.format;
	frame->width = slot.picture.width;
	frame->height = slot.picture.height;
	frame->matrix = matrix;
	frame->range = range;
	frame->timestamp_ns = libcamera_picture_time_ns(stamp ? *stamp
							      : (int64_t)metadata.timestamp);
	frame->sequence = metadata.sequence;
	frame->buffer = (int)slot.request->cookie();
	for (const auto &plane : metadata.planes())
		if (count < FRAME_PLANES)
			used[count++] = plane.bytesused;
	return libcamera_picture_planes(&slot.picture, used, count, frame->planes);
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

void Session::read_metadata(camera *camera, const lc::ControlList &metadata)
{
	const auto duration_us = metadata.get(lc::controls::FrameDuration);

	if (duration_us && *duration_us > 0)
		camera->rate_hz = 1e6 / (double)*duration_us;
	libcamera_wishes_compare(&wishes, used_value, &metadata);
}

int Session::grab(camera *camera, frame *frame)
{
	::frame newest = {}, next;
	int index = -EAGAIN;

	if (libcamera_events_deleted(&events))
		throw Failure(-ENODEV, "the camera has gone");
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
	if (index == -ENODEV && trouble && trouble != -ENODEV)
		throw refusal(trouble, "it takes no request");
	if (index == -ENODEV)
		throw Failure(-ENODEV, "the camera has gone");
	if (newest.format == PIXEL_NONE)
		return -EAGAIN;
	libcamera_picture_reading(&slots[(size_t)newest.buffer].picture, true);
	*frame = newest;
	return 0;
}

/* ---- listing ---- */

std::string value_text(const lc::ControlValue &value)
{
	const libcamera_value numbers = numbers_of(value);
	char text[LIBCAMERA_VALUE_TEXT_MAX];

	libcamera_value_text(&numbers, text);
	return numbers.count > 0 ? text : value.toString();
}

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
			const auto words = words_of(*id);
			std::string text = "control \"" + id->name() + "\" ";

			if (info.values().empty())
				text += value_text(info.min()) + ".." + value_text(info.max());
			for (const lc::ControlValue &value : info.values()) {
				const libcamera_value number = numbers_of(value);
				const auto word = words.find(number.count ? (int)number.numbers[0]
									  : -1);

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
