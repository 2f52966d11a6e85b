/* SPDX-License-Identifier: MIT */
#include <algorithm>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>
#include <strings.h>

#include "bake/mesh/gltf/gltf_parts.hpp"

extern "C" {
#include "bake/mesh/gltf/gltf.h"
#include "bake/mesh/mesh.h"
#include "hal/optics/vec.h"
}

namespace gltf
{

constexpr size_t triangles_max = 64u << 20;
constexpr double inwards_least = 0.5; /* share of the volume around the middle */
constexpr double flat_most = 1e-3;    /* height over width that has no inside */

/* Those that may be required: what they say is read, or does not change the picture, or is said to
 * be left out. */
static const char *const extensions[] = {
	"EXT_mesh_gpu_instancing",    "EXT_meshopt_compression",
#if WITH_WEBP
	"EXT_texture_webp",
#endif
	"KHR_draco_mesh_compression", "KHR_lights_punctual",
	"KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
	"KHR_materials_ior",	      "KHR_materials_pbrSpecularGlossiness",
	"KHR_materials_specular",     "KHR_materials_transmission",
	"KHR_materials_unlit",	      "KHR_materials_variants",
	"KHR_materials_volume",	      "KHR_mesh_quantization",
	"KHR_node_visibility",	      "KHR_texture_transform",
};

/* Adds what a document shows to a mesh. */
class Reader
{
      public:
	Reader(Document &from, mesh *to, double crease, bool with_materials)
	    : document(from), into(to), crease_deg(crease), nodes(from),
	      materials(from, to, &missing, with_materials)
	{
	}

	void read();

      private:
	void add_node(const Json &node, const Matrix &global);
	void add_primitive(const Json &primitive, const Json &node, const Json &shape,
			   const std::vector<Matrix> &places);
	void add_part(const Geometry &from, const Matrix &place, int material);
	void add_place(const Geometry &from, const Matrix &place, const Used &used);
	void settle_alpha();
	void leave_out();

	Document &document;
	mesh *into;
	double crease_deg;
	Nodes nodes;
	left_out missing = {};
	Materials materials;
	size_t triangles = 0;
};

/* ---- geometry ---- */

/* Moves vertices by their joints. */
static void apply_skin(Geometry &to, const std::vector<Matrix> &joints, const Json &primitive)
{
	const size_t each = to.influences.each;

	for (size_t v = 0; v < to.vertices; v++) {
		Matrix moved = {};
		double sum = 0;

		for (size_t k = v * each; k < (v + 1) * each; k++) {
			const double weight = static_cast<double>(to.influences.weight[k]);
			const float joint = to.influences.joint[k];

			if (!(joint >= 0 && joint < static_cast<float>(joints.size())))
				fail_at(primitive, -EBADMSG,
					"vertex " + std::to_string(v) + " hangs on joint " +
						std::to_string(joint) + " of " +
						std::to_string(joints.size()));
			for (int i = 0; i < 12; i++)
				moved.m[i / 4][i % 4] +=
					weight * joints[static_cast<size_t>(joint)].m[i / 4][i % 4];
			sum += weight;
		}
		if (!(sum > 0))
			continue;
		for (int i = 0; i < 12; i++)
			moved.m[i / 4][i % 4] /= sum;
		move_point(moved, &to.position[3 * v], &to.position[3 * v]);
		if (!to.normal.empty())
			move_normal(moved, &to.normal[3 * v], &to.normal[3 * v]);
		if (!to.tangent.empty())
			move_direction(moved, &to.tangent[4 * v], &to.tangent[4 * v]);
	}
}

template <typename T> static T *allocate(size_t count)
{
	void *made = calloc(std::max<size_t>(count, 1), sizeof(T));

	if (!made)
		throw std::bad_alloc();
	return static_cast<T *>(made);
}

/* Copies coordinates; those that are no numbers become 0. */
template <size_t N> static float (*copy_values(const std::vector<float> &from))[N]
{
	if (from.empty())
		return nullptr;

	auto *to = allocate<float[N]>(from.size() / N);

	for (size_t k = 0; k < from.size(); k++)
		to[k / N][k % N] = std::isfinite(from[k]) ? from[k] : 0;
	return to;
}

/* place: of directions; near: of points, which are rounded near the origin. */
static void fill_vertices(mesh_part &to, const Geometry &from, const Matrix &place,
			  const Matrix &near)
{
	for (size_t v = 0; v < from.vertices; v++) {
		float n[3];

		move_point(near, &from.position[3 * v], to.position[v]);
		if (from.normal.empty())
			continue;
		move_normal(place, &from.normal[3 * v], n);
		if (std::isfinite(n[0] + n[1] + n[2]))
			to.normal[v] = v3_unit(v3_make(n[0], n[1], n[2]));
	}
	for (size_t v = 0; to.tangent && v < from.vertices; v++) {
		move_direction(place, to.tangent[v], to.tangent[v]);
		if (determinant(place) < 0)
			to.tangent[v][3] = -to.tangent[v][3];
	}
}

static void set_origin(double origin[3], const Matrix &place, const float from[3])
{
	double vertex[3];

	for (int i = 0; i < 3; i++) {
		vertex[i] = place.m[i][3];
		for (int k = 0; k < 3; k++)
			vertex[i] += place.m[i][k] * static_cast<double>(from[k]);
	}
	mesh_set_origin(origin, vertex);
}

void Reader::add_part(const Geometry &from, const Matrix &place, int material)
{
	const size_t count = from.corners.size() / 3;
	const bool mirrored = determinant(place) < 0;

	document.take(static_cast<double>(count) * (from.normal.empty() ? 192 : 12) +
		      static_cast<double>(from.vertices) * 64);
	triangles += count;
	if (triangles > triangles_max || from.vertices > INT_MAX / 4)
		throw Failure(-EFBIG, "more than " + std::to_string(triangles_max) +
					      " triangles, expected at most as many");
	into->parts = static_cast<mesh_part *>(realloc(
		into->parts, (static_cast<size_t>(into->part_count) + 1) * sizeof(mesh_part)));
	if (!into->parts)
		throw std::bad_alloc();

	mesh_part &to = into->parts[into->part_count++];

	to = mesh_part{};
	to.material = material;
	to.vertices = static_cast<int>(from.vertices);
	to.triangles = static_cast<int>(count);
	to.position = allocate<float[4]>(from.vertices);
	to.normal = allocate<v3>(from.vertices);
	to.index = allocate<uint32_t[3]>(count);
	to.uv = copy_values<2>(from.uv[0]);
	to.uv2 = copy_values<2>(from.uv[1]);
	to.tangent = copy_values<4>(from.tangent);
	to.colour = copy_values<4>(from.colour);
	if (into->part_count == 1 && count)
		set_origin(into->origin, place, &from.position[3 * from.corners[0]]);

	Matrix near = place;

	for (int i = 0; i < 3; i++)
		near.m[i][3] -= into->origin[i];
	fill_vertices(to, from, place, near);
	for (size_t t = 0; t < count; t++) {
		to.index[t][0] = from.corners[3 * t];
		to.index[t][1] = from.corners[3 * t + (mirrored ? 2 : 1)];
		to.index[t][2] = from.corners[3 * t + (mirrored ? 1 : 2)];
	}
	if (from.normal.empty() && mesh_smooth(&to, crease_deg) < 0)
		throw std::bad_alloc();
}

/* Adds a primitive: what lets light pass, and what does not, by each triangle's middle. */
void Reader::add_place(const Geometry &from, const Matrix &place, const Used &used)
{
	if (used.dull < 0 || from.uv[used.passing.set].empty()) {
		add_part(from, place, used.material);
		return;
	}

	const std::vector<float> &uv = from.uv[used.passing.set];
	Geometry glass = from, dull = from;

	glass.corners.clear();
	dull.corners.clear();
	for (size_t t = 0; t + 2 < from.corners.size(); t += 3) {
		material_point middle = {};
		float at[2];

		for (size_t k = 0; k < 6; k++)
			middle.uv[used.passing.set][k % 2] +=
				uv[2 * from.corners[t + k / 2] + k % 2] / 3;
		texture_use_place(&used.passing, &middle, at);

		Geometry &to = texture_at(used.passing.texture, at[0], at[1]).c[0] * used.share <
					       0.5f
				       ? dull
				       : glass;

		to.corners.insert(to.corners.end(), &from.corners[t], &from.corners[t] + 3);
	}
	if (!glass.corners.empty())
		add_part(glass, place, used.material);
	if (!dull.corners.empty())
		add_part(dull, place, used.dull);
}

/* Whether most faces look towards the middle, as those of an outline or of a doll house do. */
static bool looks_inwards(const Geometry &of)
{
	double middle[3] = {0, 0, 0}, sum = 0, all = 0, room = 0;

	for (size_t k = 0; k < 3 * of.corners.size(); k++)
		middle[k % 3] += static_cast<double>(of.position[3 * of.corners[k / 3] + k % 3]) /
				 static_cast<double>(of.corners.size());
	for (size_t t = 0; t + 2 < of.corners.size(); t += 3) {
		double p[3][3], across[3], volume;

		for (size_t k = 0; k < 9; k++)
			p[k / 3][k % 3] = static_cast<double>(
						  of.position[3 * of.corners[t + k / 3] + k % 3]) -
					  middle[k % 3];
		vec_cross(p[1], p[2], across);
		volume = vec_dot(p[0], across);
		sum += volume;
		all += std::fabs(volume);
		room += vec_length(p[0]) * vec_length(across);
	}
	return sum < -inwards_least * all && all > flat_most * room;
}

/* ---- nodes ---- */

/* By how much a place makes lengths larger. */
static double scale_of(const Matrix &place)
{
	return std::cbrt(std::fabs(determinant(place)));
}

/* The weights of morph targets: those of the node, or else of the mesh. */
static std::vector<double> morph_weights(const Json &node, const Json &shape)
{
	std::vector<double> out;

	for (const Json *weight : elements(find(node, "weights") ? node : shape, "weights"))
		out.push_back(number_of(*weight));
	return out;
}

void Reader::add_primitive(const Json &primitive, const Json &node, const Json &shape,
			   const std::vector<Matrix> &places)
{
	const size_t mode = whole(primitive, "mode", MODE_MOST, TRIANGLES);
	const double lent = document.lent;
	const Json *skin = find(needed(primitive, "attributes"), "JOINTS_0") ? find(node, "skin")
									     : nullptr;

	if (mode < TRIANGLES) {
		left_out_add(&missing, mode == 0 ? "points" : "lines", "mesh");
		return;
	}

	/* joints, and not the node, say where a skin is, and how large */
	const std::vector<Matrix> joints =
		skin ? skin_matrices(document, nodes,
				     document.item("skins", document.index(*skin, "skins")))
		     : std::vector<Matrix>();
	const std::vector<Matrix> &moved = skin ? joints : places;
	const Used used = materials.use(primitive, moved.empty() ? 1 : scale_of(moved[0]));
	Geometry geometry = read_geometry(document, primitive, morph_weights(node, shape),
					  used.sets);

	for (int k = 0; k < 2; k++)
		if (used.textured[k] && geometry.uv[k].empty())
			left_out_add(&missing, "textures without coordinates", "mesh");
	if (skin && geometry.influences.each)
		apply_skin(geometry, joints, primitive);
	if (used.one_sided && looks_inwards(geometry))
		left_out_add(&missing, "hiding single-sided faces from behind", "mesh");
	for (const Matrix &place : places)
		if (skin && geometry.influences.each)
			add_place(geometry, matrix_identity, used);
		else
			add_place(geometry, place, materials.use(primitive, scale_of(place)));
	document.lent = lent;
}

void Reader::add_node(const Json &node, const Matrix &global)
{
	const Json *index = find(node, "mesh");
	const double lent = document.lent;
	std::vector<Matrix> places = instance_matrices(document, node);

	if (find_extension(node, "KHR_lights_punctual"))
		left_out_add(&missing, "light", "lamp");
	if (!index)
		return;
	for (Matrix &place : places)
		place = global * place;
	if (!find_extension(node, "EXT_mesh_gpu_instancing"))
		places.push_back(global);

	const Json &shape = document.item("meshes", document.index(*index, "meshes"));

	needed(shape, "primitives");
	for (const Json *primitive : elements(shape, "primitives"))
		add_primitive(*primitive, node, shape, places);
	document.lent = lent;
}

/* ---- all of it ---- */

static void check_document(const Document &document)
{
	const std::string version = text(needed(*document.root, "asset"), "version", "");

	if (version.compare(0, 2, "2.") != 0)
		throw Failure(-ENOTSUP, "glTF of version \"" + version + "\", expected 2.0");
	for (const Json *required : elements(*document.root, "extensionsRequired")) {
		const std::string name = text_of(*required);

		if (std::find(std::begin(extensions), std::end(extensions), name) ==
		    std::end(extensions))
			throw Failure(-ENOTSUP, "it requires the extension \"" +
							name.substr(0, 80) +
							"\", which is not known");
	}
}

/* Whether vertices of a material have alpha. */
static bool has_vertex_alpha(const mesh &of, int material)
{
	for (int p = 0; p < of.part_count; p++) {
		const mesh_part &part = of.parts[p];

		if (part.material != material || !part.colour)
			continue;
		for (int v = 0; v < part.vertices; v++)
			if (part.colour[v][3] < 1)
				return true;
	}
	return false;
}

/* Many files ask for blending where everything is opaque; rays are faster without asking. */
void Reader::settle_alpha()
{
	for (int m = 0; m < into->material_count; m++) {
		material &of = into->materials[m];

		if (of.alpha >= 1 && !(of.texture && of.texture->image.alpha) &&
		    !has_vertex_alpha(*into, m))
			of.alpha_mode = ALPHA_OPAQUE;
	}
}

void Reader::leave_out()
{
	for (size_t k = 0; k < document.count("animations"); k++)
		left_out_add(&missing, "movement", "animation");
	left_out_say(&missing, document.path.c_str());
}

void Reader::read()
{
	for (size_t node : nodes.visible)
		add_node(document.item("nodes", node), nodes.global[node]);
	settle_alpha();
	leave_out();
}

static void read_document(mesh *to, const char *path, double crease_deg, bool materials)
{
	Document document(path);

	check_document(document);
	Reader(document, to, crease_deg, materials).read();
}

} // namespace gltf

bool gltf_is(const char *path)
{
	const char *dot = strrchr(path, '.');
	char first[16] = "";
	FILE *file = nullptr;
	size_t at = 0;

	if (dot && (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0))
		return true;
	/* what is read from a pipe cannot be read again */
	if (input_stream(path, &file, nullptr) == 0 && fseek(file, 0, SEEK_SET) == 0 &&
	    !fread(first, 1, sizeof(first) - 1, file))
		first[0] = '\0';
	if (file)
		fclose(file);
	if (memcmp(first, "glTF", 4) == 0)
		return true;
	if (memcmp(first, "\xef\xbb\xbf", 3) == 0)
		at = 3;
	at += strspn(first + at, " \t\r\n");
	return first[at] == '{' || first[at] == '[';
}

int gltf_read(struct mesh *to, const char *path, double crease_deg, bool materials,
	      struct fault *why)
{
	try {
		gltf::read_document(to, path, crease_deg, materials);
		return 0;
	} catch (const gltf::Failure &e) {
		if (strncmp(e.what(), path, strlen(path)) == 0)
			return fault_say(why, e.err, "%s", e.what());
		return fault_say(why, e.err, "%s: %s", path, e.what());
	} catch (const std::bad_alloc &) {
		return fault_say(why, -ENOMEM, "%s: out of memory", path);
	} catch (const std::exception &e) {
		return fault_say(why, -EBADMSG, "%s: %s", path, e.what());
	}
}
