/* SPDX-License-Identifier: MIT */
/*
 * A glTF or GLB as JSON and bytes. Every problem is thrown as a Failure; problems with a member of
 * the JSON name it by its path, such as "/accessors/7/count".
 */
#ifndef INLAY_BAKE_MESH_GLTF_DOCUMENT_HPP
#define INLAY_BAKE_MESH_GLTF_DOCUMENT_HPP

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#define JSON_DIAGNOSTICS 1 /* errors have paths */
#include <nlohmann/json_fwd.hpp>

extern "C" {
#include "hal/base/budget.h"
#include "hal/base/input.h"
}

namespace gltf
{

/* Only document.cpp knows more of it than its name: the library takes long to compile. */
using Json = nlohmann::json;

class Failure : public std::runtime_error
{
      public:
	Failure(int code, const std::string &text) : std::runtime_error(text), err(code)
	{
	}

	const int err; /* negative errno */
};

/* Throws a Failure that names a member. */
[[noreturn]] void fail_at(const Json &member, int err, const std::string &text);

/* ---- members of the JSON, which are checked ---- */

/* An optional member; NULL: there is none. The other form fails. */
const Json *find(const Json &of, const char *name);

const Json &needed(const Json &of, const char *name);

/* An extension's object; NULL: there is none. */
const Json *find_extension(const Json &of, const char *name);

/* A whole number from 0 to most. The second form takes a fallback in place of a missing one. */
size_t whole(const Json &of, const char *name, size_t most);
size_t whole(const Json &of, const char *name, size_t most, size_t fallback);
size_t whole_of(const Json &member, size_t most);

/* A finite number. */
double number(const Json &of, const char *name, double fallback);
double number_of(const Json &member);

/* Replaces `count` numbers, if the member exists. */
bool numbers(const Json &of, const char *name, double *values, size_t count);

bool truth(const Json &of, const char *name, bool fallback);
std::string text(const Json &of, const char *name, const std::string &fallback);
std::string text_of(const Json &member);

/* The elements of an optional array. */
std::vector<const Json *> elements(const Json &of, const char *name);

/* The names of an object's members. */
std::vector<std::string> names(const Json &of);

/* An object without members. */
const Json &empty();

/* ---- bytes ---- */

struct Bytes {
	const uint8_t *at;
	size_t count;
};

/* A part of a buffer, decompressed. */
struct View {
	Bytes bytes;
	size_t stride; /* 0: elements are packed */
};

class Document
{
      public:
	explicit Document(const std::string &path);
	~Document(); /* where Json is complete */
	Document(const Document &) = delete;
	Document &operator=(const Document &) = delete;

	const std::string path;
	std::unique_ptr<Json> root;

	/* Element of one of the root's arrays, such as "accessors". */
	const Json &item(const char *array, size_t index) const;
	/* The index of such an element, which a member says. */
	size_t index(const Json &member, const char *array) const;
	size_t count(const char *array) const;

	View view(size_t index);

	/* Takes memory that is kept, or lends some until the caller sets `lent` back. */
	void take(double bytes);
	void lend(double bytes);
	double lent = 0;

	/* The file of an image: its name for messages, and its bytes. */
	Bytes image(const Json &image, std::string &name);

      private:
	struct Buffer {
		bool loaded = false;
		Bytes bytes = {nullptr, 0};
		std::vector<uint8_t> decoded;
	};

	void read_glb(Bytes whole_file);
	void parse(Bytes json);
	Bytes file(const std::string &name);
	Bytes resource(const Json &uri, std::vector<uint8_t> &decoded, std::string &name);
	Bytes buffer(size_t index);
	Bytes part(const Json &view);
	void decompress(const Json &how, std::vector<uint8_t> &out);

	budget memory = {};
	/* A file's bytes, which are freed also where the constructor throws. */
	struct Held {
		std::unique_ptr<uint8_t, void (*)(void *)> data{nullptr, free};
		size_t bytes = 0;
	};
	std::map<std::string, Held> files; /* that are read, by name */
	Bytes binary = {nullptr, 0};	   /* of a GLB */
	std::vector<Buffer> buffers;
	std::vector<std::vector<uint8_t>> decompressed; /* views */
	std::vector<std::vector<uint8_t>> pictures;	/* of data URIs */
};

/* Elements of several numbers each. Normalized integers have become fractions. */
struct Values {
	size_t count, components;
	std::vector<float> value; /* [count * components] */
};

constexpr size_t elements_max = 192u
				<< 20; /* of an accessor: corners of as many triangles as fit */

Values read_values(Document &document, size_t accessor);

/* The whole numbers of a SCALAR accessor. */
std::vector<uint32_t> read_indices(Document &document, size_t accessor);

} // namespace gltf

#endif
