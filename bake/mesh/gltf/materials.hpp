/* SPDX-License-Identifier: MIT */
/* The materials that a scene uses, and their textures. */
#ifndef INLAY_BAKE_MESH_GLTF_MATERIALS_HPP
#define INLAY_BAKE_MESH_GLTF_MATERIALS_HPP

#include <map>
#include <tuple>
#include <utility>

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
	bool one_sided;
	/* Where a texture says how much light passes: what the surface is made of where that is
	 * little, in red times the share; -1: there is no such texture. */
	int dull;
	texture_use passing;
	float share;
};

class Materials
{
      public:
	/* Materials and textures are added to the mesh, which owns them. read: whether there are
	 * any; if not, all materials are the mesh's first. */
	Materials(Document &from, mesh *to, left_out *missing, bool read);

	/* The material of a primitive, which is read when it is first used. scale: of lengths from
	 * the mesh to the world, which a volume's thickness has too. */
	Used use(const Json &primitive, double scale);

      private:
	/* Image, wrap modes, nearest, data. */
	using TextureKey = std::tuple<size_t, texture_wrap, texture_wrap, bool, bool>;

	int add(const Json &from, Used &used);
	void read(const Json &from, material &to, Used &used);
	void read_metallic(const Json &from, material &to, Used &used);
	void read_glossiness(const Json &from, material &to, Used &used);
	void read_coat(const Json &from, material &to);
	void read_glass(const Json &from, material &to, Used &used);
	double thickness_of(const Json &from, Used &used);
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
	double to_world = 1; /* scale of the material that is read */
	bool dull = false;   /* glass is left out of it */
	/* by index in the file, whose count is the default, and scale if it matters */
	std::map<std::pair<size_t, double>, Used> known;
	std::map<TextureKey, const texture *> textures;
};

} // namespace gltf

#endif
