/* SPDX-License-Identifier: MIT */

#include <algorithm>
#include <cerrno>

#include "bake/mesh/gltf/gltf_parts.hpp"

extern "C" {
#include "bake/mesh/mesh.h"
}

namespace gltf
{

/* Reads the attributes of one primitive, wherever they are. */
class Attributes
{
      public:
	Attributes(Document &from, const Json &of, const std::vector<double> &morph)
	    : document(from), primitive(of), weights(morph)
	{
		const Json *draco = find_extension(primitive, "KHR_draco_mesh_compression");

		if (draco)
			compressed = std::make_unique<Compressed>(document, *draco);
	}

	bool has(const std::string &name) const
	{
		return find(needed(primitive, "attributes"), name.c_str()) ||
		       (compressed && compressed->has(name));
	}

	Values values(const std::string &name)
	{
		const Json &said = needed(primitive, "attributes");
		const bool inside = compressed && compressed->has(name);
		const Json *accessor = inside && find(said, name.c_str())
					       ? &document.item("accessors", index(said, name))
					       : nullptr;
		Values out = inside ? compressed->values(name, accessor)
				    : read_values(document, index(said, name));

		add_morph(name, out);
		return out;
	}

	/* The values of as many vertices as there are positions. */
	Values vertex_values(const std::string &name, size_t vertices, size_t fewest, size_t most)
	{
		Values out = values(name);

		if (out.count != vertices)
			fail(name, std::to_string(out.count) + " elements, but there are " +
					   std::to_string(vertices) + " positions");
		if (out.components < fewest || out.components > most)
			fail(name, std::to_string(out.components) + " numbers an element");
		return out;
	}

	[[noreturn]] void fail(const std::string &name, const std::string &what) const
	{
		fail_at(needed(primitive, "attributes"), -EBADMSG, name + ": " + what);
	}

	/* The vertices of the primitive's triangles, or of its strip or fan. */
	std::vector<uint32_t> corners(size_t vertices)
	{
		const Json *indices = find(primitive, "indices");
		std::vector<uint32_t> out;

		if (compressed)
			return compressed->corners();
		if (indices)
			return read_indices(document, index(primitive, "indices"));
		for (size_t k = 0; k < vertices; k++)
			out.push_back(static_cast<uint32_t>(k));
		return out;
	}

	bool is_list() const /* of triangles */
	{
		return compressed || whole(primitive, "mode", MODE_MOST, TRIANGLES) == TRIANGLES;
	}

      private:
	size_t index(const Json &of, const std::string &name) const
	{
		return document.index(needed(of, name.c_str()), "accessors");
	}

	void add_morph(const std::string &name, Values &to)
	{
		const std::vector<const Json *> targets = elements(primitive, "targets");

		for (size_t t = 0; t < targets.size() && t < weights.size(); t++) {
			const Json &target = *targets[t];

			if (weights[t] == 0 || !find(target, name.c_str()))
				continue;

			const Values moved = read_values(document, index(target, name));

			/* targets move a tangent, but not its sign */
			const size_t each = moved.components;

			if (moved.count != to.count || each > to.components)
				fail_at(target, -EBADMSG,
					name + ": " + std::to_string(moved.value.size()) +
						" numbers, expected " +
						std::to_string(to.value.size()));
			for (size_t k = 0; k < moved.value.size(); k++)
				to.value[k / each * to.components + k % each] +=
					static_cast<float>(weights[t]) * moved.value[k];
		}
	}

	Document &document;
	const Json &primitive;
	const std::vector<double> &weights;
	std::unique_ptr<Compressed> compressed;
};

/* Turns a strip or a fan into triangles of the same winding. */
static std::vector<uint32_t> unroll(const std::vector<uint32_t> &from, bool fan)
{
	std::vector<uint32_t> out;

	for (size_t k = 2; k < from.size(); k++) {
		const bool odd = !fan && k % 2;

		out.push_back(fan ? from[0] : from[k - 2]);
		out.push_back(from[odd ? k : k - 1]);
		out.push_back(from[odd ? k - 1 : k]);
	}
	return out;
}

static std::vector<uint32_t> read_triangles(Attributes &attributes, const Json &primitive,
					    size_t vertices)
{
	std::vector<uint32_t> corners = attributes.corners(vertices);

	for (size_t k = 0; k < corners.size(); k++)
		if (corners[k] >= vertices)
			fail_at(primitive, -EBADMSG,
				"corner " + std::to_string(k) + " names vertex " +
					std::to_string(corners[k]) + ", expected less than " +
					std::to_string(vertices));
	if (!attributes.is_list())
		return unroll(corners, whole(primitive, "mode", MODE_MOST) == TRIANGLE_FAN);
	if (corners.size() % 3)
		fail_at(primitive, -EBADMSG,
			std::to_string(corners.size()) +
				" corners of triangles, expected a multiple of 3");
	return corners;
}

static std::vector<float> read_colour(Attributes &attributes, size_t vertices)
{
	const Values from = attributes.vertex_values("COLOR_0", vertices, 3, 4);
	std::vector<float> out(4 * vertices, 1);

	for (size_t k = 0; k < vertices; k++)
		for (size_t c = 0; c < from.components; c++)
			out[4 * k + c] = std::clamp(from.value[from.components * k + c], 0.0f,
						    1.0f);
	return out;
}

static Influences read_influences(Attributes &attributes, size_t vertices)
{
	std::vector<Values> joint, weight;
	Influences out;

	for (size_t set = 0; attributes.has("JOINTS_" + std::to_string(set)); set++) {
		const std::string number = std::to_string(set);

		joint.push_back(attributes.vertex_values("JOINTS_" + number, vertices, 4, 4));
		weight.push_back(attributes.vertex_values("WEIGHTS_" + number, vertices, 4, 4));
	}
	out.each = 4 * joint.size();
	if (!out.each)
		return out;
	out.joint.reserve(vertices * out.each);
	out.weight.reserve(vertices * out.each);
	for (size_t k = 0; k < vertices; k++)
		for (size_t set = 0; set < joint.size(); set++)
			for (size_t c = 4 * k; c < 4 * k + 4; c++) {
				out.joint.push_back(joint[set].value[c]);
				out.weight.push_back(weight[set].value[c]);
			}
	return out;
}

/* Forgets the vertices that no triangle uses: many primitives may share the arrays of all of
 * them. */
static void keep_used(Geometry &of)
{
	std::vector<uint32_t> number(of.vertices);
	const size_t used = mesh_number_used(of.corners.data(), of.corners.size(), number.data(),
					     of.vertices);

	for (auto *values : {&of.position, &of.normal, &of.tangent, &of.uv[0], &of.uv[1],
			     &of.colour, &of.influences.joint, &of.influences.weight}) {
		const size_t each = values->size() / std::max<size_t>(of.vertices, 1);

		mesh_move_rows(values->data(), each * sizeof(float), number.data(), of.vertices);
		values->resize(used * each);
		values->shrink_to_fit();
	}
	of.vertices = used;
}

Geometry read_geometry(Document &document, const Json &primitive,
		       const std::vector<double> &weights, const size_t sets[2])
{
	Attributes attributes(document, primitive, weights);
	Values position = attributes.values("POSITION");
	Geometry out = {position.count, {}, {}, {}, {}, {}, {}, {}};

	if (position.components != 3)
		attributes.fail("POSITION", "expected type \"VEC3\"");
	out.position = std::move(position.value);
	if (attributes.has("NORMAL"))
		out.normal = attributes.vertex_values("NORMAL", out.vertices, 3, 3).value;
	/* those of a surface without normals do not count, says glTF */
	if (attributes.has("NORMAL") && attributes.has("TANGENT"))
		out.tangent = attributes.vertex_values("TANGENT", out.vertices, 4, 4).value;
	for (int k = 0; k < 2; k++) {
		const std::string name = "TEXCOORD_" + std::to_string(sets[k]);

		if (!attributes.has(name))
			continue;
		out.uv[k] = attributes.vertex_values(name, out.vertices, 2, 2).value;
		for (size_t v = 1; v < out.uv[k].size(); v += 2)
			out.uv[k][v] = 1 - out.uv[k][v];
	}
	if (attributes.has("COLOR_0"))
		out.colour = read_colour(attributes, out.vertices);
	out.influences = read_influences(attributes, out.vertices);
	out.corners = read_triangles(attributes, primitive, out.vertices);
	keep_used(out);
	return out;
}

} // namespace gltf
