/* SPDX-License-Identifier: MIT */
#include "bake/mesh/gltf/document.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace gltf
{

enum Component : size_t {
	BYTE = 5120,
	UNSIGNED_BYTE = 5121,
	SHORT = 5122,
	UNSIGNED_SHORT = 5123,
	UNSIGNED_INT = 5125,
	FLOAT = 5126,
};

static size_t component_bytes(const Json &accessor, size_t type)
{
	switch (type) {
	case BYTE:
	case UNSIGNED_BYTE:
		return 1;
	case SHORT:
	case UNSIGNED_SHORT:
		return 2;
	case UNSIGNED_INT:
	case FLOAT:
		return 4;
	default:
		fail_at(accessor, -EBADMSG, "componentType " + std::to_string(type));
	}
}

/* Lends the memory of numbers: an accessor without bytes costs a hostile file nothing. */
static void lend_values(Document &document, size_t count)
{
	document.lend(static_cast<double>(count) * sizeof(float));
}

static size_t component_count(const Json &accessor)
{
	static const struct {
		const char *name;
		size_t count;
	} types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
		     {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
	const std::string name = text(accessor, "type", "");

	for (const auto &type : types)
		if (name == type.name)
			return type.count;
	fail_at(accessor, -EBADMSG, "type \"" + name + "\"");
}

/* Elements at a place in a view. */
struct Elements {
	const uint8_t *at;
	size_t count, stride;
};

/* Finds `count` elements of `bytes` bytes each, and checks that all of them are in the view. */
static Elements find_elements(Document &document, const Json &of, size_t count, size_t bytes)
{
	const size_t index = document.index(needed(of, "bufferView"), "bufferViews");
	const View view = document.view(index);
	const size_t offset = whole(of, "byteOffset", INPUT_MAX, 0);
	const size_t stride = view.stride ? view.stride : bytes;

	if (offset > view.bytes.count ||
	    (count && (view.bytes.count - offset < bytes ||
		       (view.bytes.count - offset - bytes) / stride < count - 1)))
		fail_at(of, -EBADMSG,
			std::to_string(count) + " elements from byte " + std::to_string(offset) +
				" end after bufferView " + std::to_string(index) + ", which has " +
				std::to_string(view.bytes.count) + " bytes");
	return {view.bytes.at + offset, count, stride};
}

template <typename T> static T component(const uint8_t *at)
{
	T value;

	memcpy(&value, at, sizeof(value));
	return value;
}

template <typename T>
static void convert(const Elements &from, size_t components, float scale, float *to)
{
	for (size_t k = 0; k < from.count; k++)
		for (size_t c = 0; c < components; c++) {
			const T raw = component<T>(from.at + k * from.stride + c * sizeof(T));

			*to++ = std::max(static_cast<float>(raw) * scale,
					 scale == 1 ? -3.4e38f : -1);
		}
}

static void convert_any(const Elements &from, size_t type, size_t components, bool normalized,
			float *to)
{
	switch (type) {
	case BYTE:
		convert<int8_t>(from, components, normalized ? 1 / 127.0f : 1, to);
		break;
	case UNSIGNED_BYTE:
		convert<uint8_t>(from, components, normalized ? 1 / 255.0f : 1, to);
		break;
	case SHORT:
		convert<int16_t>(from, components, normalized ? 1 / 32767.0f : 1, to);
		break;
	case UNSIGNED_SHORT:
		convert<uint16_t>(from, components, normalized ? 1 / 65535.0f : 1, to);
		break;
	case UNSIGNED_INT:
		convert<uint32_t>(from, components, normalized ? 1 / 4294967295.0f : 1, to);
		break;
	default:
		for (size_t k = 0; k < from.count; k++, to += components)
			memcpy(to, from.at + k * from.stride, components * sizeof(float));
	}
}

static uint32_t whole_component(const uint8_t *at, size_t type)
{
	return type == UNSIGNED_BYTE	? *at
	       : type == UNSIGNED_SHORT ? component<uint16_t>(at)
					: component<uint32_t>(at);
}

static std::vector<uint32_t> whole_elements(const Json &of, const Elements &from, size_t type)
{
	std::vector<uint32_t> out(from.count);

	if (type != UNSIGNED_BYTE && type != UNSIGNED_SHORT && type != UNSIGNED_INT)
		fail_at(of, -EBADMSG,
			"componentType " + std::to_string(type) + ", expected a whole number");
	for (size_t k = 0; k < from.count; k++)
		out[k] = whole_component(from.at + k * from.stride, type);
	return out;
}

/* What a sparse accessor replaces: the places, and where the new elements are. */
struct Replaced {
	std::vector<uint32_t> places;
	Elements elements;
};

static Replaced find_replaced(Document &document, const Json &sparse, size_t count, size_t bytes)
{
	const size_t replaced = whole(sparse, "count", count);
	const Json &indices = needed(sparse, "indices"), &values = needed(sparse, "values");
	const size_t type = whole(indices, "componentType", 65535);
	const Elements at = find_elements(document, indices, replaced,
					  component_bytes(indices, type));
	Replaced out = {whole_elements(indices, at, type),
			find_elements(document, values, replaced, bytes)};

	for (uint32_t place : out.places)
		if (place >= count)
			fail_at(indices, -EBADMSG,
				"element " + std::to_string(place) + " of " +
					std::to_string(count));
	return out;
}

Values read_values(Document &document, size_t index)
{
	const Json &accessor = document.item("accessors", index);
	const size_t type = whole(accessor, "componentType", 65535);
	const size_t components = component_count(accessor);
	const size_t bytes = component_bytes(accessor, type) * components;
	const size_t count = whole(accessor, "count", elements_max);
	const bool normalized = truth(accessor, "normalized", false);
	const Json *sparse = find(accessor, "sparse");
	Values out = {count, components, {}};
	Elements from = {nullptr, 0, 0};

	if (find(accessor, "bufferView"))
		from = find_elements(document, accessor, count, bytes);
	lend_values(document, count * components);
	out.value.resize(count * components); /* 0 where nothing says otherwise */
	convert_any(from, type, components, normalized, out.value.data());
	if (!sparse)
		return out;

	const Replaced replaced = find_replaced(document, *sparse, count, bytes);
	std::vector<float> values(replaced.places.size() * components);

	convert_any(replaced.elements, type, components, normalized, values.data());
	for (size_t k = 0; k < replaced.places.size(); k++)
		std::copy_n(&values[k * components], components,
			    &out.value[replaced.places[k] * components]);
	return out;
}

std::vector<uint32_t> read_indices(Document &document, size_t index)
{
	const Json &accessor = document.item("accessors", index);
	const size_t type = whole(accessor, "componentType", 65535);
	const size_t bytes = component_bytes(accessor, type);
	const size_t count = whole(accessor, "count", elements_max);
	const Json *sparse = find(accessor, "sparse");
	std::vector<uint32_t> out;

	if (component_count(accessor) != 1)
		fail_at(accessor, -EBADMSG, "expected type \"SCALAR\" for indices");
	lend_values(document, count);
	if (find(accessor, "bufferView"))
		out = whole_elements(accessor, find_elements(document, accessor, count, bytes),
				     type);
	out.resize(count);
	if (!sparse)
		return out;

	const Replaced replaced = find_replaced(document, *sparse, count, bytes);
	const std::vector<uint32_t> values = whole_elements(accessor, replaced.elements, type);

	for (size_t k = 0; k < values.size(); k++)
		out[replaced.places[k]] = values[k];
	return out;
}

} // namespace gltf
