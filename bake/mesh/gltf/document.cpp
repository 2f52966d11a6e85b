/* SPDX-License-Identifier: MIT */
#include "bake/mesh/gltf/document.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

namespace gltf
{

constexpr int depth_max = 64; /* meshes need about 10, besides their "extras" */
constexpr uint32_t chunk_json = 0x4e4f534a, chunk_binary = 0x004e4942; /* "JSON", "BIN\0" */

/* ---- members ---- */

void fail_at(const Json &member, int err, const std::string &text)
{
	/* the library has the path of a member, but only its exceptions tell it */
	std::string what = Json::other_error::create(501, text, &member).what();

	what.erase(0, what.find("] ") + 2);
	if (what[0] == '(') {
		what.erase(0, 1);
		what.replace(what.find(')'), 1, ":");
	}
	throw Failure(err, what);
}

const Json *find(const Json &of, const char *name)
{
	const auto at = of.find(name);

	return at == of.end() ? nullptr : &*at;
}

const Json *find_extension(const Json &of, const char *name)
{
	const Json *extensions = find(of, "extensions");

	return extensions ? find(*extensions, name) : nullptr;
}

const Json &needed(const Json &of, const char *name)
{
	const Json *member = find(of, name);

	if (!member)
		fail_at(of, -EBADMSG, std::string("there is no \"") + name + "\"");
	return *member;
}

double number_of(const Json &member)
{
	const double value = member.is_number() ? member.get<double>()
						: std::numeric_limits<double>::quiet_NaN();

	if (!std::isfinite(value))
		fail_at(member, -EBADMSG, member.dump().substr(0, 40) + ", expected a number");
	return value;
}

size_t whole_of(const Json &member, size_t most)
{
	const double value = number_of(member);

	if (value < 0 || value > static_cast<double>(most) || value != std::floor(value))
		fail_at(member, -EBADMSG,
			member.dump().substr(0, 40) + ", expected a whole number from 0 to " +
				std::to_string(most));
	return static_cast<size_t>(value);
}

size_t whole(const Json &of, const char *name, size_t most)
{
	return whole_of(needed(of, name), most);
}

size_t whole(const Json &of, const char *name, size_t most, size_t fallback)
{
	const Json *member = find(of, name);

	return member ? whole_of(*member, most) : fallback;
}

double number(const Json &of, const char *name, double fallback)
{
	const Json *member = find(of, name);

	return member ? number_of(*member) : fallback;
}

bool numbers(const Json &of, const char *name, double *values, size_t count)
{
	const Json *member = find(of, name);

	if (!member)
		return false;
	if (!member->is_array() || member->size() != count)
		fail_at(*member, -EBADMSG, "expected " + std::to_string(count) + " numbers");
	for (size_t k = 0; k < count; k++)
		values[k] = number_of((*member)[k]);
	return true;
}

bool truth(const Json &of, const char *name, bool fallback)
{
	const Json *member = find(of, name);

	if (member && !member->is_boolean())
		fail_at(*member, -EBADMSG, "expected true or false");
	return member ? member->get<bool>() : fallback;
}

std::string text_of(const Json &member)
{
	if (!member.is_string())
		fail_at(member, -EBADMSG, "expected a text");
	return member.get<std::string>();
}

std::string text(const Json &of, const char *name, const std::string &fallback)
{
	const Json *member = find(of, name);

	return member ? text_of(*member) : fallback;
}

std::vector<const Json *> elements(const Json &of, const char *name)
{
	const Json *array = find(of, name);
	std::vector<const Json *> out;

	if (array && !array->is_array())
		fail_at(*array, -EBADMSG, "expected an array");
	for (size_t k = 0; array && k < array->size(); k++)
		out.push_back(&(*array)[k]);
	return out;
}

std::vector<std::string> names(const Json &of)
{
	std::vector<std::string> out;

	if (!of.is_object())
		fail_at(of, -EBADMSG, "expected an object");
	for (auto member = of.begin(); member != of.end(); ++member)
		out.push_back(member.key());
	return out;
}

const Json &empty()
{
	static const Json object = Json::object();

	return object;
}

/* ---- URIs ---- */

static int hex_digit(char c)
{
	return c >= '0' && c <= '9'   ? c - '0'
	       : c >= 'a' && c <= 'f' ? c - 'a' + 10
	       : c >= 'A' && c <= 'F' ? c - 'A' + 10
				      : -1;
}

static std::string percent_decode(const std::string &uri)
{
	std::string out;

	for (size_t k = 0; k < uri.size(); k++) {
		const int high = uri[k] == '%' && k + 2 < uri.size() ? hex_digit(uri[k + 1]) : -1;
		const int low = high >= 0 ? hex_digit(uri[k + 2]) : -1;

		if (low >= 0) {
			out += static_cast<char>(16 * high + low);
			k += 2;
		} else {
			out += uri[k];
		}
	}
	return out;
}

static int base64_digit(char c)
{
	return c >= 'A' && c <= 'Z'   ? c - 'A'
	       : c >= 'a' && c <= 'z' ? c - 'a' + 26
	       : c >= '0' && c <= '9' ? c - '0' + 52
	       : c == '+' || c == '-' ? 62
	       : c == '/' || c == '_' ? 63
				      : -1;
}

/* Decodes the text of a data URI, "data:type;base64,...". */
static std::vector<uint8_t> data_decode(const Json &uri, const std::string &text)
{
	const size_t comma = text.find(',');
	std::vector<uint8_t> out;
	uint32_t bits = 0;
	int held = 0;

	if (comma == std::string::npos)
		fail_at(uri, -EBADMSG, "a data URI without a comma");
	if (comma < 7 || text.compare(comma - 7, 7, ";base64") != 0) {
		const std::string plain = percent_decode(text.substr(comma + 1));

		return {plain.begin(), plain.end()};
	}
	out.reserve((text.size() - comma) / 4 * 3);
	for (size_t k = comma + 1; k < text.size() && text[k] != '='; k++) {
		const int digit = base64_digit(text[k]);

		if (digit < 0)
			fail_at(uri, -EBADMSG,
				"character " + std::to_string(k) + " is none of base64");
		bits = bits << 6 | static_cast<uint32_t>(digit);
		held += 6;
		if (held >= 8) {
			held -= 8;
			out.push_back(static_cast<uint8_t>(bits >> held));
		}
	}
	return out;
}

/* ---- the file ---- */

Bytes Document::file(const std::string &name)
{
	fault why = {""};
	const auto added = files.try_emplace(name);
	Held &held = added.first->second;
	uint8_t *data = nullptr;

	if (added.second) {
		const int err = input_read(name.c_str(), INPUT_MAX, &data, &held.bytes, &why);

		held.data.reset(data);
		if (err)
			throw Failure(err, why.text);
		memory.file_bytes += held.bytes;
	}
	return {held.data.get(), held.bytes};
}

void Document::lend(double bytes)
{
	fault why = {""};

	lent += bytes;
	if (budget_fits(&memory, lent, path.c_str(), &why))
		throw Failure(-EFBIG, why.text);
}

void Document::take(double bytes)
{
	lend(bytes);
	lent -= bytes;
	memory.taken += bytes;
}

static uint32_t little32(const uint8_t *at)
{
	return at[0] | static_cast<uint32_t>(at[1]) << 8 | static_cast<uint32_t>(at[2]) << 16 |
	       static_cast<uint32_t>(at[3]) << 24;
}

[[noreturn]] static void fail_length(const char *what, size_t said, size_t held)
{
	throw Failure(-EBADMSG, std::string("its ") + what + " says that it has " +
					std::to_string(said) + " bytes, but there are " +
					std::to_string(held) + ": damaged or cut short");
}

/* Finds the chunks of a GLB: a header of 12 bytes, then chunks, each with its length and type. */
void Document::read_glb(Bytes file)
{
	Bytes json = {nullptr, 0};
	size_t at = 12;

	if (file.count < 20)
		fail_length("header", 20, file.count);
	if (little32(file.at + 4) != 2)
		throw Failure(-ENOTSUP, "a GLB of version " +
						std::to_string(little32(file.at + 4)) +
						", expected 2");
	if (little32(file.at + 8) < 20 || little32(file.at + 8) > file.count)
		fail_length("header", little32(file.at + 8), file.count);
	file.count = little32(file.at + 8);
	while (file.count - at >= 8) {
		const Bytes chunk = {file.at + at + 8, little32(file.at + at)};
		const uint32_t type = little32(file.at + at + 4);

		at += 8;
		if (chunk.count > file.count - at)
			fail_length("chunk", chunk.count, file.count - at);
		at += chunk.count;
		if (type == chunk_json && !json.at)
			json = chunk;
		if (type == chunk_binary && !binary.at)
			binary = chunk;
	}
	if (!json.at)
		throw Failure(-EBADMSG, "a GLB without JSON");
	parse(json);
}

void Document::parse(Bytes json)
{
	const char *from = reinterpret_cast<const char *>(json.at);
	const auto check_depth = [](int depth, Json::parse_event_t, Json &) {
		if (depth > depth_max)
			throw Failure(-E2BIG, "JSON nested more than " + std::to_string(depth_max) +
						      " deep, expected a mesh");
		return true;
	};

	if (json.count >= 3 && memcmp(from, "\xef\xbb\xbf", 3) == 0) {
		from += 3;
		json.count -= 3;
	}
	try {
		root = std::make_unique<Json>(Json::parse(from, from + json.count, check_depth));
	} catch (const Json::exception &e) {
		/* without the number that it begins with */
		throw Failure(-EBADMSG, strstr(e.what(), "] ") + 2 +
						std::string(", expected the JSON of a glTF"));
	}
	if (!root->is_object())
		throw Failure(-EBADMSG, "its JSON is no object, expected a glTF");
}

Document::Document(const std::string &name) : path(name)
{
	const Bytes whole_file = file(path);

	if (whole_file.count >= 4 && memcmp(whole_file.at, "glTF", 4) == 0)
		read_glb(whole_file);
	else
		parse(whole_file);
	buffers.resize(count("buffers"));
	decompressed.resize(count("bufferViews"));
}

Document::~Document() = default;

size_t Document::count(const char *array) const
{
	const Json *items = find(*root, array);

	if (items && !items->is_array())
		fail_at(*items, -EBADMSG, "expected an array");
	return items ? items->size() : 0;
}

const Json &Document::item(const char *array, size_t index) const
{
	if (index >= count(array))
		throw Failure(-EBADMSG, std::string("/") + array + "/" + std::to_string(index) +
						": there are only " + std::to_string(count(array)));
	return (*root)[array][index];
}

size_t Document::index(const Json &member, const char *array) const
{
	const size_t items = count(array);

	if (!items)
		fail_at(member, -EBADMSG, std::string("there are no ") + array);
	return whole_of(member, items - 1);
}

/* ---- buffers ---- */

/* The bytes that a URI names. name: of the file, for messages. */
Bytes Document::resource(const Json &uri, std::vector<uint8_t> &decoded, std::string &name)
{
	if (!uri.is_string())
		fail_at(uri, -EBADMSG, "expected a URI");

	const std::string &said = uri.get_ref<const std::string &>();

	if (said.compare(0, 5, "data:") == 0) {
		decoded = data_decode(uri, said);
		return {decoded.data(), decoded.size()};
	}
	if (said.find("://") != std::string::npos)
		fail_at(uri, -ENOTSUP, "\"" + said.substr(0, 80) + "\", expected a file or data:");
	name = percent_decode(said);
	std::replace(name.begin(), name.end(), '\\', '/');
	if (name.compare(0, 1, "/") != 0)
		name.insert(0, path, 0, path.rfind('/') + 1);
	return file(name);
}

Bytes Document::buffer(size_t index)
{
	const Json &what = item("buffers", index);
	Buffer &b = buffers[index];

	if (b.loaded)
		return b.bytes;

	const size_t bytes = whole(what, "byteLength", INPUT_MAX);
	const Json *uri = find(what, "uri");
	std::string name = path;

	if (uri)
		b.bytes = resource(*uri, b.decoded, name);
	else if (index == 0 && binary.at)
		b.bytes = binary;
	else
		fail_at(what, -EBADMSG, "it has no bytes, expected a \"uri\"");
	if (b.bytes.count < bytes)
		fail_at(what, -EBADMSG,
			(name == path ? "" : name + " has ") + std::to_string(b.bytes.count) +
				" bytes, expected " + std::to_string(bytes));
	b.bytes.count = bytes;
	b.loaded = true;
	return b.bytes;
}

/* The bytes of a view, or of an extension that has the same members. */
Bytes Document::part(const Json &view)
{
	const size_t number = index(needed(view, "buffer"), "buffers");
	const Bytes all = buffer(number);
	const size_t offset = whole(view, "byteOffset", INPUT_MAX, 0);
	const size_t bytes = whole(view, "byteLength", INPUT_MAX);

	if (offset > all.count || bytes > all.count - offset)
		fail_at(view, -EBADMSG,
			"bytes " + std::to_string(offset) + " to " +
				std::to_string(offset + bytes) + " of buffer " +
				std::to_string(number) + ", which has " +
				std::to_string(all.count));
	return {all.at + offset, bytes};
}

/* Undoes EXT_meshopt_compression. */
void Document::decompress(const Json &how, std::vector<uint8_t> &out)
{
	const Bytes from = part(how);
	const size_t stride = whole(how, "byteStride", 256);
	const size_t elements = whole(how, "count", std::numeric_limits<uint32_t>::max());
	const std::string mode = text(how, "mode", ""), filter = text(how, "filter", "NONE");
	const bool vertices = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
	int err;

	if (!vertices && !triangles && mode != "INDICES")
		fail_at(how, -ENOTSUP, "mode \"" + mode + "\"");
	if (vertices ? stride == 0 || stride % 4 : stride != 2 && stride != 4)
		fail_at(how, -EBADMSG, "byteStride " + std::to_string(stride));
	if (triangles && elements % 3)
		fail_at(how, -EBADMSG, "count " + std::to_string(elements) + " of triangles");
	take(static_cast<double>(elements) * static_cast<double>(stride));
	out.resize(std::max<size_t>(elements * stride, 1));
	err = vertices ? meshopt_decodeVertexBuffer(out.data(), elements, stride, from.at,
						    from.count)
	      : triangles
		      ? meshopt_decodeIndexBuffer(out.data(), elements, stride, from.at, from.count)
		      : meshopt_decodeIndexSequence(out.data(), elements, stride, from.at,
						    from.count);
	if (err)
		fail_at(how, -EBADMSG, "its bytes cannot be decompressed: damaged");
	if (filter == "OCTAHEDRAL" && vertices && (stride == 4 || stride == 8))
		meshopt_decodeFilterOct(out.data(), elements, stride);
	else if (filter == "QUATERNION" && vertices && stride == 8)
		meshopt_decodeFilterQuat(out.data(), elements, stride);
	else if (filter == "EXPONENTIAL" && vertices)
		meshopt_decodeFilterExp(out.data(), elements, stride);
	else if (filter != "NONE")
		fail_at(how, -ENOTSUP, "filter \"" + filter + "\"");
}

View Document::view(size_t index)
{
	const Json &what = item("bufferViews", index);
	const Json *how = find_extension(what, "EXT_meshopt_compression");
	const size_t stride = whole(what, "byteStride", 252, 0);

	if (!how)
		return {part(what), stride};
	if (decompressed[index].empty())
		decompress(*how, decompressed[index]);
	return {{decompressed[index].data(), decompressed[index].size()}, stride};
}

Bytes Document::image(const Json &image, std::string &name)
{
	const Json *uri = find(image, "uri"), *inside = find(image, "bufferView");

	name = path;
	if (inside)
		return view(index(*inside, "bufferViews")).bytes;
	if (!uri)
		fail_at(image, -EBADMSG, "neither \"uri\" nor \"bufferView\"");
	pictures.emplace_back();
	return resource(*uri, pictures.back(), name);
}

} // namespace gltf
