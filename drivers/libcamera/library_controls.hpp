/* SPDX-License-Identifier: MIT */
/* Converts controls between libcamera's types and those of controls.h. */
#ifndef INLAY_DRIVERS_LIBCAMERA_LIBRARY_CONTROLS_HPP
#define INLAY_DRIVERS_LIBCAMERA_LIBRARY_CONTROLS_HPP

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "drivers/libcamera/library.hpp"

extern "C" {
#include "drivers/libcamera/parts.h"
}

namespace libcamera_driver
{

/* Returns the controls that a camera has; they point into known. */
std::vector<libcamera_control> controls_of(const lc::ControlInfoMap &known);

/* Returns the names of a control's values, where this version of libcamera knows them. */
std::map<int32_t, std::string> words_of(const lc::ControlId &id);

libcamera_value numbers_of(const lc::ControlValue &value);

/* Puts the wishes that are due into the controls of the next request. Returns which they are. */
libcamera_load put_wishes(libcamera_wishes &wishes, lc::ControlList &controls);

/* Fetches what the camera used for a control: get() of libcamera_wishes_compare(). metadata is a
 * lc::ControlList. */
bool used_value(const void *metadata, const void *theirs, libcamera_value *value) noexcept;

} // namespace libcamera_driver

#endif
