/* SPDX-License-Identifier: MIT */
/* Formats come in libcamera's order, then controls in alphabetical order. */
#include "drivers/libcamera/driver.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace libcamera_driver
{

namespace
{

std::string value_text(const lc::ControlValue &value)
{
	const libcamera_value numbers = numbers_of(value);
	char text[LIBCAMERA_VALUE_TEXT_MAX];

	libcamera_value_text(&numbers, text);
	return numbers.count > 0 ? text : value.toString();
}

std::vector<std::string> format_lines(lc::Camera &device)
{
	const auto configuration = proposal(device);
	std::vector<std::string> lines;

	if (!configuration)
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

std::string control_line(const lc::ControlId &id, const lc::ControlInfo &info)
{
	const auto words = words_of(id);
	std::string text = "control \"" + id.name() + "\" ";

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
	return text;
}

std::vector<std::string> control_lines(const lc::Camera &device)
{
	std::vector<std::string> lines;

	for (const auto &[id, info] : device.controls())
		lines.push_back(control_line(*id, info));
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
	listing.lines = lines.empty() ? nullptr : &lines.data()->text;
	listing.line_count = (int)lines.size();
	found(context, &listing);
}

} // namespace

int list(void (*found)(void *, const camera_listing *), void *context)
{
	const Manager manager;
	const auto cameras = manager.cameras();

	for (const auto &device : cameras)
		show(*device, found, context);
	return (int)cameras.size();
}

} // namespace libcamera_driver
