/* SPDX-License-Identifier: MIT */
/* `theirs` of controls.h is a lc::ControlId here. */
#include "drivers/libcamera/driver.hpp"

#include <algorithm>
#include <climits>
#include <cstdio>

#include <strings.h>

namespace libcamera_driver
{

namespace
{

const lc::ControlId &id_of(const void *theirs)
{
	return *static_cast<const lc::ControlId *>(theirs);
}

/* Returns the length of an array control; 0: a single value. */
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

bool number_of_word(const void *theirs, const char *word, double *number) noexcept
{
	for (const auto &[value, known] : words_of(id_of(theirs)))
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

lc::ControlValue value_of(const libcamera_wish &wish)
{
	lc::ControlValue value;

	value.reserve(id_of(wish.control->theirs).type(), wish.control->elements > 0,
		      (size_t)wish.value.count);
	libcamera_value_pack(&wish.value, value.data().data());
	return value;
}

} // namespace

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

std::map<int32_t, std::string> words_of(const lc::ControlId &id)
{
#if LIBCAMERA_AT_LEAST(0, 4)
	return id.enumerators();
#else
	(void)id;
	return {};
#endif
}

libcamera_value numbers_of(const lc::ControlValue &value)
{
	libcamera_value numbers;

	libcamera_value_unpack(&numbers, kind_of(value.type()), (int)value.numElements(),
			       value.data().data());
	return numbers;
}

libcamera_load put_wishes(libcamera_wishes &wishes, lc::ControlList &controls)
{
	const libcamera_load load = libcamera_wishes_next(&wishes);

	for (int i = load.first; i < load.first + load.count; i++) {
		const libcamera_wish &wish = wishes.list[i];

		controls.set(id_of(wish.control->theirs).id(), value_of(wish));
	}
	return load;
}

bool used_value(const void *metadata, const void *theirs, libcamera_value *value) noexcept
{
	const auto &list = *static_cast<const lc::ControlList *>(metadata);
	const unsigned id = id_of(theirs).id();

	if (!list.contains(id))
		return false;
	*value = numbers_of(list.get(id));
	return true;
}

} // namespace libcamera_driver
