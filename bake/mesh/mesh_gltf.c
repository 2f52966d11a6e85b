/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh_gltf.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "bake/mesh/plain_file.h"

#define DEPTH_MAX 64 /* meshes need about 10, besides their "extras" */
#define BLANKS " \t\r\n"

/* Layout of a GLB. It is little-endian, like all data that this program reads in place. */
struct glb_header {
	char magic[4];
	uint32_t version, bytes;
};

struct glb_chunk {
	uint32_t bytes, type;
};

static int check_depth(const char *json, size_t bytes, const char *path, struct fault *fault)
{
	int depth = 0;
	bool in_text = false;

	for (size_t k = 0; k < bytes; k++) {
		const char c = json[k];

		if (c == '"')
			in_text = !in_text;
		else if (in_text && c == '\\')
			k++;
		else if (!in_text && (c == '{' || c == '['))
			depth++;
		else if (!in_text && (c == '}' || c == ']'))
			depth--;
		if (depth > DEPTH_MAX)
			return fault_say(fault, -E2BIG,
					 "%s: JSON nested more than %d deep at byte %zu, expected "
					 "a mesh",
					 path, DEPTH_MAX, k);
	}
	return 0;
}

static int say_length(const char *path, const char *what, uint64_t bytes, size_t held,
		      struct fault *fault)
{
	return fault_say(fault, -EBADMSG,
			 "%s: its %s says that it has %llu bytes, but there are %zu: damaged or "
			 "cut short",
			 path, what, (unsigned long long)bytes, held);
}

static int check_chunks(const char *at, size_t left, const char *path, struct fault *fault)
{
	struct glb_chunk chunk;
	int err = 0;

	while (!err && left >= sizeof(chunk)) {
		memcpy(&chunk, at, sizeof(chunk));
		at += sizeof(chunk);
		left -= sizeof(chunk);
		if (chunk.bytes > left)
			return say_length(path, "chunk", chunk.bytes, left, fault);
		err = check_depth(at, memcmp(&chunk.type, "JSON", 4) == 0 ? chunk.bytes : 0, path,
				  fault);
		at += chunk.bytes;
		left -= chunk.bytes;
	}
	return err;
}

/* In version 1 the length and type of the JSON follow the header, in later versions chunks do. */
static int check_glb(const struct plain_map *file, const char *path, struct fault *fault)
{
	struct glb_header header;
	struct glb_chunk json;
	const size_t heads = sizeof(header) + sizeof(json);

	if (file->bytes < heads)
		return say_length(path, "header", heads, file->bytes, fault);
	memcpy(&header, file->at, sizeof(header));
	memcpy(&json, file->at + sizeof(header), sizeof(json));
	if (header.bytes < heads || header.bytes > file->bytes)
		return say_length(path, "header", header.bytes, file->bytes, fault);
	if (header.version != 1)
		return check_chunks(file->at + sizeof(header), header.bytes - sizeof(header), path,
				    fault);
	if (json.bytes > header.bytes - heads)
		return say_length(path, "JSON", json.bytes, header.bytes - heads, fault);
	return check_depth(file->at + heads, json.bytes, path, fault);
}

/* Tells whether a file may be JSON, whatever its name: assimp, too, looks at the contents. */
static bool may_be_json(const struct plain_map *file)
{
	size_t at = file->bytes >= 3 && memcmp(file->at, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;

	while (at < file->bytes && file->at[at] && strchr(BLANKS, file->at[at]))
		at++;
	return at < file->bytes && (file->at[at] == '{' || file->at[at] == '[');
}

int mesh_gltf_check(const char *path, struct fault *fault)
{
	struct plain_map file;
	int err = plain_file_map(&file, path, PLAIN_FILE_MAX, fault);

	if (err)
		return err;
	if (file.bytes >= 4 && memcmp(file.at, "glTF", 4) == 0)
		err = check_glb(&file, path, fault);
	else if (may_be_json(&file))
		err = check_depth(file.at, file.bytes, path, fault);
	plain_file_unmap(&file);
	return err;
}
