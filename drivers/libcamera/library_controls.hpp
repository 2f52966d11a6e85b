/* SPDX-License-Identifier: MIT */
/* Controls between libcamera's types and those of controls.h. */
#ifndef INLAY_DRIVERS_LIBCAMERA_LIBRARY_CONTROLS_HPP
#define INLAY_DRIVERS_LIBCAMERA_LIBRARY_CONTROLS_HPP

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "drivers/libcamera/library.hpp"

extern "C" {
#include "drivers/libcamera/controls.h"
}

namespace libcamera_driver
{

/* The controls that a camera has; they point into known. */
std::vector<libcamera_control> controls_of(const lc::ControlInfoMap &known);

/* The words for a control's values, where libcamera tells them. */
std::map<int32_t, std::string> words_of(const lc::ControlId &id);

libcamera_value numbers_of(const lc::ControlValue &value);

/* Puts what the next request is to carry into its controls. */
libcamera_load put_wishes(libcamera_wishes &wishes, lc::ControlList &controls);

/* What the camera used for a control, for libcamera_wishes_compare(); metadata is a
 * lc::ControlList.
 */
bool used_value(const void *metadata, const void *theirs, libcamera_value *value) noexcept;

} // namespace libcamera_driver

#endif
