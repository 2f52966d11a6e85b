/* SPDX-License-Identifier: MIT */
/* The materials that a scene uses, and their textures. */
#ifndef INLAY_BAKE_MESH_GLTF_MATERIALS_HPP
#define INLAY_BAKE_MESH_GLTF_MATERIALS_HPP

#include <map>
#include <tuple>

#include "bake/mesh/gltf/document.hpp"

extern "C" {
#include "bake/mesh/left_out.h"
#include "bake/mesh/mesh.h"
}

namespace gltf
{

/* A material of the mesh. Its textures use two sets of coordinates, whatever their numbers. */
struct Used {
	int material;
	size_t sets[2];
	bool textured[2]; /* which of them textures use */
};

class Materials
{
      public:
	/* Materials and textures are added to the mesh, which owns them. read: whether there are
	 * any; if not, all materials are the mesh's first. */
	Materials(Document &from, mesh *to, left_out *missing, bool read);

	/* The material of a primitive, which is read when it is first used. */
	Used use(const Json &primitive);

      private:
	/* Image, wrap modes, nearest, data. */
	using TextureKey = std::tuple<size_t, texture_wrap, texture_wrap, bool, bool>;

	void read(const Json &from, material &to, Used &used);
	void read_metallic(const Json &from, material &to, Used &used);
	void read_glossiness(const Json &from, material &to, Used &used);
	void read_coat(const Json &from, material &to);
	void read_glass(const Json &from, material &to);
	void read_alpha(const Json &from, material &to);
	void leave_out(const Json &from);
	void set_colour(const Json *info, material &to, Used &used);
	texture_use read_use(const Json &info, bool data, Used &used);
	const texture *read_texture(const Json &info, bool data);
	const texture *load_texture(const TextureKey &key);

	Document &document;
	mesh *into;
	left_out *missing;
	bool wanted;
	std::map<size_t, Used> known; /* by index in the file; its count: the default */
	std::map<TextureKey, const texture *> textures;
};

} // namespace gltf

#endif
