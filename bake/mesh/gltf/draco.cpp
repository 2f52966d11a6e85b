/* SPDX-License-Identifier: MIT */
#include "bake/mesh/gltf/gltf_parts.hpp"

#include <algorithm>
#include <cerrno>
#include <cfloat>
#include <cmath>
#include <exception>

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/metadata_decoder.h>

namespace gltf
{

/* Lends the memory that a decoder allocates, which believes all numbers: of faces and points here,
 * of attributes below. Returns the kind of its mesh. */
static uint8_t lend_claimed(Document &document, const Json &extension, draco::DecoderBuffer buffer)
{
	draco::DracoHeader header = {};
	draco::GeometryMetadata metadata;
	uint32_t first = 0, second = 0;
	uint8_t traversal;
	bool fine = draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok();

	if (fine && (header.version_major != 2 || header.version_minor != 2))
		fail_at(extension, -ENOTSUP,
			"Draco's format " + std::to_string(header.version_major) + "." +
				std::to_string(header.version_minor) + ", expected 2.2");
	buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
	if (fine && header.flags & METADATA_FLAG_MASK)
		fine = draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata);
	if (fine && header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
		fine = buffer.Decode(&traversal);
	if (fine && draco::DecodeVarint(&first, &buffer) && draco::DecodeVarint(&second, &buffer))
		document.lend(128.0 * (static_cast<double>(first) + static_cast<double>(second)));
	return header.encoder_method;
}

/* A decoder of the library that lends the memory of its attributes before it reads their values. */
template <typename Kind> class Lending : public Kind
{
      public:
	explicit Lending(Document &of) : document(of)
	{
	}

	std::exception_ptr refusal;

      protected:
	/* Nothing is thrown through the library. */
	bool DecodeAllAttributes() override
	try {
		const draco::PointCloud &cloud = *this->point_cloud();

		/* each value as it is packed, in whole numbers, and in float; its number for each
		 * point */
		for (int k = 0; k < cloud.num_attributes(); k++)
			document.lend(static_cast<double>(cloud.num_points()) *
				      (static_cast<double>(cloud.attribute(k)->byte_stride()) +
				       8.0 * cloud.attribute(k)->num_components() + 4));
		return Kind::DecodeAllAttributes();
	} catch (const Failure &) {
		refusal = std::current_exception();
		return false;
	}

      private:
	Document &document;
};

template <typename Kind>
static std::unique_ptr<draco::Mesh> decode(Document &document, const Json &extension,
					   draco::DecoderBuffer &buffer)
{
	auto mesh = std::make_unique<draco::Mesh>();
	Lending<Kind> decoder(document);
	const draco::Status status = decoder.Decode(draco::DecoderOptions(), &buffer, mesh.get());

	if (decoder.refusal)
		std::rethrow_exception(decoder.refusal);
	if (!status.ok())
		fail_at(extension, -EBADMSG,
			"Draco cannot decompress it: " + status.error_msg_string());
	return mesh;
}

Compressed::Compressed(Document &document, const Json &extension)
    : attributes(needed(extension, "attributes"))
{
	const size_t view = document.index(needed(extension, "bufferView"), "bufferViews");
	const Bytes from = document.view(view).bytes;
	draco::DecoderBuffer buffer;

	buffer.Init(reinterpret_cast<const char *>(from.at), from.count);
	mesh = lend_claimed(document, extension, buffer) == draco::MESH_EDGEBREAKER_ENCODING
		       ? decode<draco::MeshEdgebreakerDecoder>(document, extension, buffer)
		       : decode<draco::MeshSequentialDecoder>(document, extension, buffer);
}

Compressed::~Compressed() = default;

bool Compressed::has(const std::string &attribute) const
{
	return find(attributes, attribute.c_str());
}

/* What turns the decoder's values into those that the accessor says: its "normalized" counts, which
 * encoders do not always repeat inside. */
static float accessor_scale(const draco::PointAttribute &from, const Json &accessor)
{
	const bool normalized = truth(accessor, "normalized", false);
	const size_t type = whole(accessor, "componentType", 65535);
	const auto most_of = [](int bytes, bool sign) {
		return static_cast<float>(std::ldexp(1, 8 * bytes - sign) - 1);
	};
	const draco::DataType own = from.data_type();
	const bool sign = own == draco::DT_INT8 || own == draco::DT_INT16 || own == draco::DT_INT32;

	if (normalized == from.normalized() || !draco::IsDataTypeIntegral(own))
		return 1;
	if (normalized && type >= 5120 && type <= 5123)
		return 1 / most_of(type < 5122 ? 1 : 2, type % 2 == 0);
	return normalized ? 1 : most_of(draco::DataTypeLength(own), sign);
}

Values Compressed::values(const std::string &attribute, const Json *accessor) const
{
	const size_t id = whole(attributes, attribute.c_str(), 65535);
	const draco::PointAttribute *from = mesh->GetAttributeByUniqueId(static_cast<uint32_t>(id));

	if (!from)
		fail_at(attributes, -EBADMSG,
			attribute + ": the compressed data have no attribute " +
				std::to_string(id));

	if (from->num_components() > 4)
		fail_at(attributes, -EBADMSG,
			attribute + ": " + std::to_string(from->num_components()) +
				" numbers an element");

	const auto components = static_cast<int8_t>(from->num_components());
	const float scale = accessor ? accessor_scale(*from, *accessor) : 1;
	Values out = {mesh->num_points(), static_cast<size_t>(components), {}};

	out.value.resize(out.count * out.components);
	for (uint32_t k = 0; k < mesh->num_points(); k++) {
		const draco::AttributeValueIndex at = from->mapped_index(draco::PointIndex(k));

		if (at.value() >= from->size() ||
		    !from->ConvertValue<float>(at, components, &out.value[k * out.components]))
			fail_at(attributes, -EBADMSG, attribute + ": damaged");
	}
	for (float &value : out.value)
		value = std::max(value * scale, scale < 1 ? -1 : -FLT_MAX);
	return out;
}

std::vector<uint32_t> Compressed::corners() const
{
	std::vector<uint32_t> out;

	out.reserve(3 * static_cast<size_t>(mesh->num_faces()));
	for (uint32_t f = 0; f < mesh->num_faces(); f++)
		for (int k = 0; k < 3; k++)
			out.push_back(mesh->face(draco::FaceIndex(f))[k].value());
	return out;
}

} // namespace gltf
