/* SPDX-License-Identifier: MIT */
#include "bake/mesh/gltf/gltf_parts.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>

extern "C" {
#include "bake/base/picture_file.h"
}

namespace gltf
{

constexpr float glass_rough = 0.1f; /* roughness above which smooth glass looks different */
constexpr double metal_much = 0.5;

/* Extensions that are read, or that need not be. */
static const char *const known_extensions[] = {
	"KHR_materials_clearcoat", "KHR_materials_emissive_strength",
	"KHR_materials_ior",	   "KHR_materials_pbrSpecularGlossiness",
	"KHR_materials_specular",  "KHR_materials_transmission",
	"KHR_materials_unlit",	   "KHR_materials_volume",
};

static float clamped(double value)
{
	return static_cast<float>(std::clamp(value, 0.0, 1.0));
}

static rgb rgb_of(const double c[3])
{
	return {{clamped(c[0]), clamped(c[1]), clamped(c[2])}};
}

/* ---- textures ---- */

template <typename T> static T *grow(T *array, int count)
{
	void *grown = realloc(array, (static_cast<size_t>(count) + 1) * sizeof(T));

	if (!grown)
		throw std::bad_alloc();
	return static_cast<T *>(grown);
}

const texture *Materials::load_texture(const TextureKey &key)
{
	const Json &from = document.item("images", std::get<0>(key));
	fault why = {""};
	std::string name;
	const Bytes bytes = document.image(from, name);
	int err;

	if (name == document.path)
		name = "/images/" + std::to_string(std::get<0>(key));
	into->textures = grow(into->textures, into->texture_count);

	auto *made = static_cast<texture *>(calloc(1, sizeof(texture)));

	if (!made)
		throw std::bad_alloc();
	err = image_read_memory_deep(bytes.at, bytes.count, name.c_str(), &made->image, &why);
	if (!err && picture_file_decode(&made->image, std::get<4>(key)) < 0) {
		image_free(&made->image);
		free(made);
		throw std::bad_alloc();
	}
	if (err) {
		free(made);
		throw Failure(err, why.text);
	}
	made->wrap[0] = std::get<1>(key);
	made->wrap[1] = std::get<2>(key);
	made->nearest = std::get<3>(key);
	if (std::get<4>(key))
		texture_prepare_data(made);
	else
		texture_prepare(made);
	into->textures[into->texture_count++] = made;
	document.take(static_cast<double>(made->image.width) * made->image.height *
		      (made->image.f32 ? 3 * sizeof(float) + 1 : 4));
	return made;
}

static texture_wrap wrap_of(const Json *sampler, const char *name)
{
	constexpr size_t repeat = 10497, clamp = 33071, mirror = 33648;
	const size_t mode = sampler ? whole(*sampler, name, 65535, repeat) : repeat;

	if (mode != repeat && mode != clamp && mode != mirror)
		fail_at(*sampler, -EBADMSG, std::string(name) + " " + std::to_string(mode));
	return mode == clamp ? TEXTURE_CLAMP : mode == mirror ? TEXTURE_MIRROR : TEXTURE_REPEAT;
}

/* info: what names the texture. data: its values are no colours. */
const texture *Materials::read_texture(const Json &info, bool data)
{
	constexpr size_t nearest = 9728;
	const Json &from = document.item("textures",
					 document.index(needed(info, "index"), "textures"));
	const Json *webp = WITH_WEBP ? find_extension(from, "EXT_texture_webp") : nullptr;
	const Json *source = find(webp ? *webp : from, "source");
	const Json *sampler = find(from, "sampler");

	if (!source)
		fail_at(from, -ENOTSUP,
			"it has no \"source\" of a known kind, expected PNG, JPEG or WebP");
	if (sampler)
		sampler = &document.item("samplers", document.index(*sampler, "samplers"));

	const TextureKey key = {document.index(*source, "images"), wrap_of(sampler, "wrapS"),
				wrap_of(sampler, "wrapT"),
				sampler && whole(*sampler, "magFilter", 65535, 0) == nearest, data};
	const auto at = textures.find(key);

	if (at != textures.end())
		return at->second;
	return textures[key] = load_texture(key);
}

/*
 * Where a texture is looked up. With (u, v) of the file, whose v runs downwards,
 * KHR_texture_transform says
 *     u' = c sx u + s sy v + ox,  v' = -s sx u + c sy v + oy,  c, s: of the rotation
 * and the mesh has v upwards, 1 - v, before and after.
 */
texture_use Materials::read_use(const Json &info, bool data, Used &used)
{
	const Json *transform = find_extension(info, "KHR_texture_transform");
	double offset[2] = {0, 0}, scale[2] = {1, 1}, angle = 0;
	size_t set = whole(info, "texCoord", 63, 0);
	texture_use out = {read_texture(info, data), 0, {0, 0, 0, 0, 0, 0}};

	if (transform) {
		numbers(*transform, "offset", offset, 2);
		numbers(*transform, "scale", scale, 2);
		angle = number(*transform, "rotation", 0);
		set = whole(*transform, "texCoord", 63, set);
	}

	const double c = std::cos(angle), s = std::sin(angle);
	const double place[6] = {c * scale[0], -s * scale[1], s * scale[1] + offset[0],
				 s * scale[0], c * scale[1],  1 - c * scale[1] - offset[1]};

	for (int k = 0; k < 6; k++)
		out.place[k] = static_cast<float>(place[k]);
	if (used.textured[0] && used.sets[0] != set) {
		if (used.textured[1] && used.sets[1] != set)
			fail_at(info, -ENOTSUP,
				"a third set of texture coordinates, expected two in a material");
		out.set = 1;
	}
	used.sets[out.set] = set;
	used.textured[out.set] = true;
	return out;
}

void Materials::set_colour(const Json *info, material &to, Used &used)
{
	static const float as_it_is[6] = {1, 0, 0, 0, 1, 0};

	if (!info)
		return;

	const texture_use use = read_use(*info, false, used);

	to.texture = use.texture;
	if (use.set || memcmp(use.place, as_it_is, sizeof(as_it_is)) != 0)
		to.placed = use;
}

/* The means of a texture's channels. */
static rgb texture_mean(const texture *from)
{
	const image &image = from->image;
	const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
	double sum[3] = {0, 0, 0};

	for (size_t k = 0; k < 3 * pixels; k++)
		sum[k % 3] += static_cast<double>(image.u8 ? from->decode[image.u8[k]]
							   : image.f32[k]);
	for (double &s : sum)
		s /= static_cast<double>(pixels);
	return rgb_of(sum);
}

/* ---- kinds ---- */

/* Sets base, coat and metal of a metalness and roughness; dielectric: reflectance without metal. */
static void set_metallic(material &to, rgb base, rgb dielectric, float metallic, float roughness)
{
	to.kind = MATERIAL_GLOSSY;
	to.roughness = roughness;
	to.metal = rgb_scale(base, metallic);
	to.colour = rgb_scale(base, 1 - metallic);
	to.specular = rgb_add(rgb_scale(dielectric, 1 - metallic), to.metal);
}

/* Reflectance at normal incidence of what is no metal, by its index of refraction. */
static rgb dielectric_of(const Json &from, double ior)
{
	const Json *specular = find_extension(from, "KHR_materials_specular");
	const double root = (ior - 1) / (ior + 1);
	double colour[3] = {1, 1, 1}, factor = 1;

	if (specular) {
		factor = number(*specular, "specularFactor", 1);
		numbers(*specular, "specularColorFactor", colour, 3);
	}
	for (double &c : colour)
		c = std::min(c * root * root, 1.0) * factor;
	return rgb_of(colour);
}

static double ior_of(const Json &from)
{
	const Json *ior = find_extension(from, "KHR_materials_ior");
	const double value = ior ? number(*ior, "ior", 1.5) : 1.5;

	if (value != 0 && value < 1)
		fail_at(*ior, -EBADMSG, "an index of refraction below 1");
	return value == 0 ? 1.5 : value; /* 0 is for the model of glossiness */
}

void Materials::read_metallic(const Json &from, material &to, Used &used)
{
	const Json *said = find(from, "pbrMetallicRoughness");
	const Json &model = said ? *said : empty();
	const Json *map = find(model, "metallicRoughnessTexture");
	const Json *specular = find_extension(from, "KHR_materials_specular");
	double base[4] = {1, 1, 1, 1};
	const rgb dielectric = dielectric_of(from, ior_of(from));
	const float metallic = clamped(number(model, "metallicFactor", 1));
	const float roughness = clamped(number(model, "roughnessFactor", 1));
	rgb mean = {{1, 1, 1}};

	numbers(model, "baseColorFactor", base, 4);
	to.alpha = clamped(base[3]);
	set_colour(find(model, "baseColorTexture"), to, used);
	if (map) {
		to.map.use = read_use(*map, true, used);
		to.map.base = rgb_of(base);
		to.map.specular = dielectric;
		to.map.metallic = metallic;
		to.map.roughness = roughness;
		mean = texture_mean(to.map.use.texture);
	}
	set_metallic(to, rgb_of(base), dielectric, metallic * mean.c[2], roughness * mean.c[1]);
	/* a factor of 0 takes the coat away, also at grazing angles; a colour of 0 does not */
	if (specular && metallic == 0 && number(*specular, "specularFactor", 1) == 0)
		to.kind = MATERIAL_DIFFUSE;
}

void Materials::read_glossiness(const Json &model, material &to, Used &used)
{
	const Json *map = find(model, "specularGlossinessTexture");
	double diffuse[4] = {1, 1, 1, 1}, specular[3] = {1, 1, 1};
	const double gloss = number(model, "glossinessFactor", 1);

	numbers(model, "diffuseFactor", diffuse, 4);
	numbers(model, "specularFactor", specular, 3);
	to.alpha = clamped(diffuse[3]);
	set_colour(find(model, "diffuseTexture"), to, used);
	to.kind = MATERIAL_GLOSSY;
	to.roughness = clamped(1 - gloss);
	to.specular = rgb_of(specular);
	if (map) {
		to.map.use = read_use(*map, false, used);
		to.map.glossiness = true;
		to.map.base = rgb_of(diffuse);
		to.map.specular = to.specular;
		to.map.roughness = to.roughness;
		to.specular = rgb_mul(to.specular, texture_mean(to.map.use.texture));
	}
	to.colour = rgb_scale(rgb_of(diffuse), 1 - rgb_peak(to.specular));
}

/* A clear coat on a base that is no metal hides the base's own coat: both have the same index of
 * refraction, so that nothing is reflected between them. */
void Materials::read_coat(const Json &from, material &to)
{
	const Json *coat = find_extension(from, "KHR_materials_clearcoat");
	const double factor = coat ? number(*coat, "clearcoatFactor", 0) : 0;

	if (factor <= 0)
		return;
	if (to.map.use.texture || static_cast<double>(rgb_peak(to.metal)) > metal_much ||
	    factor < metal_much) {
		left_out_add(missing, "clear coats", "material");
		return;
	}
	to.roughness = clamped(number(*coat, "clearcoatRoughnessFactor", 0));
	if (find(*coat, "clearcoatTexture") || find(*coat, "clearcoatRoughnessTexture"))
		left_out_add(missing, "textures of clear coats", "material");
}

/* A volume's thickness in the world. A texture of it counts by its mean. */
double Materials::thickness_of(const Json &from, Used &used)
{
	const Json *volume = find_extension(from, "KHR_materials_volume");
	const Json *map = volume ? find(*volume, "thicknessTexture") : nullptr;
	double thickness = volume ? number(*volume, "thicknessFactor", 0) * to_world : 0;

	if (map && thickness > 0)
		thickness *=
			static_cast<double>(texture_mean(read_use(*map, true, used).texture).c[1]);
	return thickness;
}

/* Light is tinted wherever it passes a surface; that which a volume takes is divided between the
 * two surfaces of its said thickness. */
void Materials::read_glass(const Json &from, material &to, Used &used)
{
	const Json *glass = find_extension(from, "KHR_materials_transmission");
	const Json *volume = find_extension(from, "KHR_materials_volume");
	const Json *map = glass ? find(*glass, "transmissionTexture") : nullptr;
	const double factor = glass ? number(*glass, "transmissionFactor", 0) : 0;
	double tint[3] = {1, 1, 1};

	if (factor <= 0)
		return;
	if (factor < 1 || map)
		left_out_add(missing, "partial transmission", "material");
	if (factor < metal_much || dull)
		return;
	if (map) {
		used.passing = read_use(*map, true, used);
		used.share = static_cast<float>(factor);
	}

	const double thickness = thickness_of(from, used);
	const double distance = volume ? number(*volume, "attenuationDistance", 0) : 0;

	if (to.roughness > glass_rough)
		left_out_add(missing, "roughness of glass", "material");
	if (volume && distance > 0)
		numbers(*volume, "attenuationColor", tint, 3);
	for (double &c : tint)
		c = std::pow(std::clamp(c, 0.0, 1.0), thickness / std::max(distance, 1e-9) / 2);
	to.kind = MATERIAL_GLASS;
	to.map.use.texture = nullptr; /* its colours know nothing of the tint */
	to.colour = rgb_mul(rgb_add(to.colour, to.metal), rgb_of(tint));
	to.ior = static_cast<float>(ior_of(from));
	to.thin = thickness <= 0;
}

void Materials::read_alpha(const Json &from, material &to)
{
	const std::string mode = text(from, "alphaMode", "OPAQUE");

	if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND")
		fail_at(from, -EBADMSG, "alphaMode \"" + mode + "\"");
	to.alpha_mode = mode == "MASK" ? ALPHA_MASK : mode == "BLEND" ? ALPHA_BLEND : ALPHA_OPAQUE;
	to.alpha_cut = static_cast<float>(number(from, "alphaCutoff", 0.5));
}

/* Counts what the renderer does not show. */
void Materials::leave_out(const Json &from)
{
	const Json *extensions = find(from, "extensions");
	const Json *specular = find_extension(from, "KHR_materials_specular");
	const Json *strength = find_extension(from, "KHR_materials_emissive_strength");
	double light[3] = {0, 0, 0};

	numbers(from, "emissiveFactor", light, 3);
	if (std::max({light[0], light[1], light[2]}) *
		    (strength ? number(*strength, "emissiveStrength", 1) : 1) >
	    0)
		left_out_add(missing, "emission", "material");
	if (find_extension(from, "KHR_materials_unlit"))
		left_out_add(missing, "brightness without light", "material");
	if (specular &&
	    (find(*specular, "specularTexture") || find(*specular, "specularColorTexture")))
		left_out_add(missing, "textures of specular", "material");
	if (!extensions)
		return;
	for (const std::string &name : names(*extensions))
		if (std::find(std::begin(known_extensions), std::end(known_extensions), name) ==
		    std::end(known_extensions))
			left_out_add(missing, name.c_str(), "material");
}

void Materials::read(const Json &from, material &to, Used &used)
{
	const Json *glossiness = find_extension(from, "KHR_materials_pbrSpecularGlossiness");
	const Json *bumps = find(from, "normalTexture");

	to.ior = 1.5f;
	if (glossiness)
		read_glossiness(*glossiness, to, used);
	else
		read_metallic(from, to, used);
	if (find_extension(from, "KHR_materials_unlit")) {
		to.kind = MATERIAL_DIFFUSE;
		to.colour = rgb_add(to.colour, to.metal);
		to.map.use.texture = nullptr;
	} else {
		read_coat(from, to);
		read_glass(from, to, used);
	}
	if (bumps) {
		to.bumps = read_use(*bumps, true, used);
		to.bump_scale = static_cast<float>(number(*bumps, "scale", 1));
	}
	read_alpha(from, to);
	leave_out(from);
}

/* ---- all of them ---- */

Materials::Materials(Document &from, mesh *to, left_out *what, bool read)
    : document(from), into(to), missing(what), wanted(read)
{
}

int Materials::add(const Json &from, Used &used)
{
	const int index = into->material_count;

	into->materials = grow(into->materials, index);
	into->materials[index] = material{};
	into->material_count++;
	read(from, into->materials[index], used);
	return index;
}

Used Materials::use(const Json &primitive, double scale)
{
	const Json *said = find(primitive, "material");
	const size_t index = said ? document.index(*said, "materials")
				  : document.count("materials");
	const Json &from = said ? document.item("materials", index) : empty();
	/* instances whose scales differ by less share a material */
	const double coarse = std::exp2(std::round(std::log2(scale) * 256) / 256);

	to_world = find_extension(from, "KHR_materials_volume") && std::isfinite(coarse) ? coarse
											 : 1;

	const auto at = known.find({index, to_world});
	Used used = {0, {0, 1}, {false, false}, false, -1, {}, 0};

	if (at != known.end())
		return at->second;
	if (wanted) {
		used.one_sided = !truth(from, "doubleSided", false);
		used.material = add(from, used);
		if (used.passing.texture) {
			const left_out once = *missing;

			dull = true;
			used.dull = add(from, used);
			dull = false;
			*missing = once;
		}
	}
	return known[{index, to_world}] = used;
}

} // namespace gltf
