/* SPDX-License-Identifier: MIT */
/* Accessors: typed numbers in the bytes of a document. Every index is checked. */
#ifndef INLAY_BAKE_MESH_GLTF_ACCESSOR_HPP
#define INLAY_BAKE_MESH_GLTF_ACCESSOR_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bake/mesh/gltf/document.hpp"

namespace gltf
{

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
