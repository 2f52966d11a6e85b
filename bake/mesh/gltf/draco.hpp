/* SPDX-License-Identifier: MIT */
/* A primitive that is compressed by Draco (KHR_draco_mesh_compression). */
#ifndef INLAY_BAKE_MESH_GLTF_DRACO_HPP
#define INLAY_BAKE_MESH_GLTF_DRACO_HPP

#include <memory>

#include "bake/mesh/gltf/accessor.hpp"

namespace draco
{
class Mesh;
}

namespace gltf
{

class Compressed
{
      public:
	/* extension: the object of the primitive's extension */
	Compressed(Document &document, const Json &extension);
	~Compressed();

	/* Whether an attribute, such as "POSITION", is in the compressed data. */
	bool has(const std::string &attribute) const;
	/* accessor: of the attribute; NULL: it has none. */
	Values values(const std::string &attribute, const Json *accessor) const;
	std::vector<uint32_t> corners() const; /* of triangles */

      private:
	const Json &attributes;
	std::unique_ptr<draco::Mesh> mesh;
};

} // namespace gltf

#endif
