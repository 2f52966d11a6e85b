# SPDX-License-Identifier: MIT
"""Scenes of blender.sh: a ball and a box of one material on grey ground, exported and rendered by Blender.

    blender -b --factory-startup -P blender.py -- FOLDER SAMPLES [NAME ...]

For each name, or all: FOLDER/NAME.glb, .obj or .ply, NAME.scene for inlay-bake, and NAME.exr by Cycles. Further
sky.hdr, the light of all, ground.exr, the ground without objects, and cases.txt, a line for each case: name,
least PSNR in dB, and why it is no more.
"""
import json
import math
import os
import struct
import sys

import bpy
import numpy

WIDTH, HEIGHT, FIELD_DEG = 160, 120, 40
EYE, TARGET = (1.0, -4.2, 2.6), (0, 0, 0.42)
GREY = 0.5  # of the ground
BOUNCES = 6
LEAST_DB = 36

HERE, SAMPLES = sys.argv[sys.argv.index("--") + 1], int(sys.argv[sys.argv.index("--") + 2])
CHOSEN = sys.argv[sys.argv.index("--") + 3 :]


# ---- pictures, by formulas ----


def grid(width, height):
    """u to the right and v upwards, 0..1, at the middle of each pixel; rows begin at the bottom, as in Blender."""
    return numpy.meshgrid((numpy.arange(width) + 0.5) / width, (numpy.arange(height) + 0.5) / height)


def picture(name, channels, data, suffix="png"):
    """A picture in a file; channels: 3 or 4 arrays of code values. data: they are no colours."""
    height, width = channels[0].shape
    image = bpy.data.images.new(name, width, height, alpha=len(channels) == 4, float_buffer=suffix == "hdr")
    image.colorspace_settings.name = "Non-Color" if data else "sRGB"
    if len(channels) == 3:
        channels = [*channels, numpy.ones_like(channels[0])]
    image.pixels.foreach_set(numpy.stack(channels, 2).astype(numpy.float32).ravel())
    image.filepath_raw = os.path.join(HERE, f"{name}.{suffix}")
    image.file_format = "HDR" if suffix == "hdr" else "PNG"
    image.save()
    return image


def waves(u, v, across, down):
    return 0.5 + 0.5 * numpy.sin(2 * math.pi * across * u) * numpy.cos(2 * math.pi * down * v)


def colours():
    u, v = grid(64, 64)
    return picture("colours", (0.25 + 0.7 * u, 0.2 + 0.7 * v, 0.3 + 0.5 * waves(u, v, 3, 2)), False)


def surfaces():
    """Roughness in green, metalness in blue, as glTF has them."""
    u, v = grid(64, 64)
    return picture("surfaces", (numpy.ones_like(u), 0.3 + 0.6 * waves(u, v, 2, 1), v > 0.5), True)


def bumps():
    """Normals of z = (sin 2 pi 6 u) (cos 2 pi 4 v) / 60, a texture being 1 x 1."""
    u, v = grid(128, 128)
    a, b = 2 * math.pi * 6, 2 * math.pi * 4
    slopes = (a * numpy.cos(a * u) * numpy.cos(b * v) / 60, -b * numpy.sin(a * u) * numpy.sin(b * v) / 60)
    length = numpy.sqrt(slopes[0] ** 2 + slopes[1] ** 2 + 1)
    return picture("bumps", [0.5 + 0.5 * n / length for n in (-slopes[0], -slopes[1], 1)], True)


def holes():
    """Colours with an alpha that is soft at the edges of its spots."""
    u, v = grid(64, 64)
    return picture("holes", (0.9 * u + 0.1, 0.6 + 0 * u, 0.2 + 0.6 * v, waves(u, v, 4, 3)), False)


def sky():
    """A sky that is blue above and bright at one side, with a wide sun; nothing below the horizon."""
    u, v = grid(256, 128)
    azimuth, height = (0.5 - u) * 2 * math.pi, (v - 0.5) * math.pi
    towards = numpy.cos(height) * numpy.cos(azimuth - 4.0) * math.cos(0.8) + numpy.sin(height) * math.sin(0.8)
    sun = 4 * numpy.exp((towards - 1) / 0.02)
    side = 0.25 + 0.15 * numpy.cos(azimuth)
    above = numpy.sin(numpy.maximum(height, 0))
    up = v > 0.5
    mixed = [up * (side + k * above + sun * s) for k, s in ((0.05, 1), (0.12, 0.9), (0.3, 0.7))]
    return picture("sky", mixed, True, "hdr")


# ---- materials ----


class Nodes:
    """A material of one Principled shader, which the exporters understand."""

    def __init__(self, **inputs):
        self.material = bpy.data.materials.new("stuff")
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.shader = self.tree.nodes["Principled BSDF"]
        self.shader.distribution = "MULTI_GGX"  # light that meets several microfacets is not lost
        for name, value in inputs.items():
            self.set(name.replace("_", " "), value)

    def set(self, name, value):
        socket = self.shader.inputs[name]
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif isinstance(value, tuple):
            socket.default_value = (*value, 1)
        else:
            socket.default_value = value

    def add(self, kind, *inputs):
        """A node; inputs by their place: sockets, numbers, or None."""
        node = self.tree.nodes.new("ShaderNode" + kind)
        for socket, value in zip(node.inputs, inputs):
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            elif value is not None:
                socket.default_value = value
        return node

    def texture(self, image, place=None):
        node = self.add("TexImage", place)
        node.image = image
        return node

    def normals(self, image, strength=1.0):
        node = self.add("NormalMap", strength, self.texture(image).outputs["Color"])
        self.set("Normal", node.outputs[0])


def plain(**inputs):
    return lambda: Nodes(**inputs)


def textured():
    nodes = Nodes(Roughness=0.6)
    nodes.set("Base Color", nodes.texture(colours()).outputs["Color"])
    return nodes


def rough_and_metal():
    nodes = textured()
    parts = nodes.add("SeparateColor", nodes.texture(surfaces()).outputs["Color"])
    nodes.set("Roughness", parts.outputs["Green"])
    nodes.set("Metallic", parts.outputs["Blue"])
    return nodes


def moved():
    """A texture that is moved, turned and scaled."""
    nodes = Nodes(Roughness=0.6)
    place = nodes.add("Mapping", nodes.add("TexCoord").outputs["UV"], (0.2, 0.35, 0), (0, 0, 0.5), (1.7, 2.6, 1))
    nodes.set("Base Color", nodes.texture(colours(), place.outputs[0]).outputs["Color"])
    return nodes


def other_coordinates():
    nodes = Nodes(Roughness=0.6)
    place = nodes.add("UVMap")
    place.uv_map = "other"
    nodes.set("Base Color", nodes.texture(colours(), place.outputs[0]).outputs["Color"])
    return nodes


def normal_map():
    nodes = textured()
    nodes.set("Metallic", 1.0)
    nodes.set("Roughness", 0.3)
    nodes.normals(bumps(), 0.6)
    return nodes


def vertex_colours(**inputs):
    nodes = Nodes(Roughness=0.7, **inputs)
    colour = nodes.add("VertexColor")
    colour.layer_name = "paint"
    nodes.set("Base Color", colour.outputs["Color"])
    return nodes


def matt_colours():
    return vertex_colours(Specular=0.0)


def blended():
    nodes = Nodes(Roughness=0.7)
    texture = nodes.texture(holes())
    nodes.set("Base Color", texture.outputs["Color"])
    nodes.set("Alpha", texture.outputs["Alpha"])
    nodes.material.blend_method = "BLEND"
    return nodes


def masked():
    nodes = blended()
    nodes.material.blend_method = "CLIP"
    nodes.material.alpha_threshold = 0.6
    return nodes


def cut_out(nodes):
    """What Cycles needs to be told, once the file is written."""
    cut = nodes.add("Math", nodes.shader.inputs["Alpha"].links[0].from_socket, 0.6)
    cut.operation = "GREATER_THAN"
    nodes.set("Alpha", cut.outputs[0])


def solid_glass():
    """The exporter takes a volume from a group of this name, Cycles from the ball as it is."""
    nodes = Nodes(Base_Color=(0.8, 0.95, 0.9), Roughness=0.0, Transmission=1.0, IOR=1.5)
    group = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
    group.inputs.new("NodeSocketFloat", "Thickness")
    group.nodes.new("NodeGroupInput")
    node = nodes.add("Group")
    node.node_tree = group
    node.inputs[0].default_value = 1
    return nodes


def thin_glass():
    return Nodes(Base_Color=(0.7, 0.9, 0.8), Roughness=0.0, Transmission=1.0, IOR=1.5)


def panes(nodes):
    """glTF's glass without a volume is a thin pane: 2 r / (1 + r) is mirrored, the rest goes straight on."""
    fresnel = nodes.add("Fresnel", None)
    back = nodes.add("NewGeometry").outputs["Backfacing"]

    def calculate(operation, *inputs):
        node = nodes.add("Math", *inputs)
        node.operation = operation
        return node.outputs[0]

    # the node takes a surface's back for its inside, and the reciprocal there
    nodes.tree.links.new(calculate("POWER", 1.5, calculate("MULTIPLY_ADD", back, -2, 1)), fresnel.inputs[0])
    r = fresnel.outputs[0]
    share = calculate("DIVIDE", calculate("MULTIPLY", r, 2), calculate("ADD", r, 1))
    through = nodes.add("BsdfTransparent", (0.7, 0.9, 0.8, 1))
    mirror = nodes.add("BsdfGlossy", (1, 1, 1, 1), 0.0)
    mix = nodes.add("MixShader", share, through.outputs[0], mirror.outputs[0])
    nodes.tree.links.new(mix.outputs[0], nodes.tree.nodes["Material Output"].inputs["Surface"])


# ---- files ----


def export_glb(path, **options):
    bpy.ops.export_scene.gltf(filepath=path, export_format="GLB", **options)


def export_separate(path):
    bpy.ops.export_scene.gltf(filepath=path, export_format="GLTF_SEPARATE")


def export_tangents(path):
    export_glb(path, export_tangents=True)


def export_glossiness(path):
    """The same material said by the older model: specular, glossiness."""
    export_glb(path)
    with open(path, "rb") as file:
        data = file.read()
    length = struct.unpack_from("<I", data, 12)[0]
    said = json.loads(data[20 : 20 + length])
    for material in said["materials"]:
        metal = material.pop("pbrMetallicRoughness")
        material["extensions"] = {
            "KHR_materials_pbrSpecularGlossiness": {
                "diffuseFactor": metal["baseColorFactor"],
                "specularFactor": [0.04, 0.04, 0.04],
                "glossinessFactor": 1 - metal["roughnessFactor"],
            }
        }
    said["extensionsUsed"] = ["KHR_materials_pbrSpecularGlossiness"]
    text = json.dumps(said).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text + rest)


def export_obj(path):
    bpy.ops.wm.obj_export(filepath=path, export_pbr_extensions=True, path_mode="STRIP")


def export_old_obj(path):
    bpy.ops.wm.obj_export(filepath=path, path_mode="STRIP")


def export_ply(path):
    """Without normals: which edges are sharp the reader has to find."""
    bpy.ops.export_mesh.ply(filepath=path, use_ascii=False, use_normals=False)


def export_ply_text(path):
    bpy.ops.export_mesh.ply(filepath=path, use_ascii=True)


def smoothed(_nodes):
    """PLY has one normal a vertex, and the exporter writes that of a smooth surface."""
    for thing in bpy.data.objects:
        thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))


GLTF, OBJ, PLY = (".glb", export_glb), (".obj", export_obj), (".ply", export_ply)
matt = plain(Base_Color=(0.7, 0.4, 0.2), Specular=0.0, Roughness=0.5)
plastic = plain(Base_Color=(0.1, 0.3, 0.6), Roughness=0.25)
coated = plain(Base_Color=(0.5, 0.1, 0.1), Roughness=0.6, Clearcoat=1.0, Clearcoat_Roughness=0.05)
glowing = plain(Base_Color=(0.3, 0.3, 0.3), Roughness=0.6, Emission=(1.0, 0.5, 0.1), Emission_Strength=0.5)
gold = plain(Base_Color=(0.9, 0.6, 0.25), Metallic=1.0, Roughness=0.35)

# Name, material, file, and what Cycles is told besides.
CASES = (
    ("matt", matt, GLTF),
    ("plastic", plastic, GLTF),
    ("metal", gold, GLTF),
    ("textures", rough_and_metal, GLTF),
    ("separate", moved, (".gltf", export_separate)),
    ("second-uv", other_coordinates, GLTF),
    ("normal-map", normal_map, GLTF),
    ("tangents", normal_map, (".glb", export_tangents)),
    ("vertex-colours", vertex_colours, GLTF),
    ("mask", masked, GLTF, cut_out),
    ("blend", blended, GLTF),
    ("glass", solid_glass, GLTF),
    ("panes", thin_glass, GLTF, panes),
    ("clearcoat", coated, GLTF),
    ("emission", glowing, GLTF),
    ("glossiness", plastic, (".glb", export_glossiness)),
    ("obj-matt", matt, OBJ),
    ("obj-plastic", plastic, OBJ),
    ("obj-metal", gold, OBJ),
    ("obj-textures", textured, OBJ),
    ("obj-normal-map", normal_map, OBJ),
    ("obj-alpha", plain(Base_Color=(0.7, 0.4, 0.2), Roughness=0.5, Alpha=0.5), OBJ),
    ("obj-old", gold, (".obj", export_old_obj)),
    ("ply", matt_colours, PLY),
    ("ply-text", matt_colours, (".ply", export_ply_text), smoothed),
)

# What a picture is further from, and why.
DIFFERENCES = {
    "emission": (15, "an object's own light is left out, and said"),
}


# ---- scenes ----


def add_things(painted):
    """A ball that is smooth and a box that is sharp and turned, with two sets of coordinates. Painted: with colours,
    which a glTF multiplies every material by, and Blender only those that ask for them."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=0.6, location=(-0.65, 0, 0.6))
    bpy.ops.object.shade_smooth()
    ball = bpy.context.object
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0.75, 0.1, 0.42), rotation=(0, 0, 0.5), scale=(0.9, 0.7, 0.8))
    things = [ball, bpy.context.object]
    for thing in things:
        mesh = thing.data
        corners = numpy.empty(2 * len(mesh.loops), numpy.float32)
        mesh.uv_layers[0].data.foreach_get("uv", corners)
        mesh.uv_layers.new(name="other").data.foreach_set("uv", 1 - 2 * corners)
        mesh.uv_layers.active_index = 0
        if not painted:
            continue
        shade = [(*(0.2 + 0.6 * (0.5 + v.co[axis] / 1.3) for axis in range(3)), 1) for v in mesh.vertices]
        if painted == "POINT":  # the exporter of glTF mixes up colours of corners
            paint = mesh.color_attributes.new("paint", "FLOAT_COLOR", "POINT")
            for colour, to in zip(shade, paint.data):
                to.color = colour
        else:
            paint = mesh.color_attributes.new("paint", "BYTE_COLOR", "CORNER")
            for loop, to in zip(mesh.loops, paint.data):
                to.color = shade[loop.vertex_index]
    return things


def add_ground():
    bpy.ops.mesh.primitive_plane_add(size=2000)
    material = bpy.data.materials.new("ground")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (GREY, GREY, GREY, 1)
    material.node_tree.links.new(shader.outputs[0], nodes["Material Output"].inputs["Surface"])
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


def set_world(scene):
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    nodes = scene.world.node_tree.nodes
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(os.path.join(HERE, "sky.hdr"), check_existing=False)
    scene.world.node_tree.links.new(texture.outputs["Color"], nodes["Background"].inputs["Color"])
    scene.world.cycles.sampling_method, scene.world.cycles.sample_map_resolution = "MANUAL", 256


def set_camera(scene):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "HORIZONTAL"
    data.angle = math.radians(FIELD_DEG)
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    towards = bpy.data.objects.new("target", None)
    towards.location = TARGET
    scene.collection.objects.link(towards)
    scene.camera.location = EYE
    look = scene.camera.constraints.new("TRACK_TO")
    look.target, look.track_axis, look.up_axis = towards, "TRACK_NEGATIVE_Z", "UP_Y"


def set_cycles(scene):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples = SAMPLES
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.diffuse_bounces = cycles.glossy_bounces = BOUNCES
    cycles.max_bounces = cycles.transmission_bounces = cycles.transparent_max_bounces = 4 * BOUNCES
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.view_settings.view_transform = "Raw"
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"


def render(scene, name):
    scene.render.filepath = os.path.join(HERE, name + ".exr")
    bpy.ops.render.render(write_still=True)


def write_scene(name, file):
    with open(os.path.join(HERE, name + ".scene"), "w", encoding="ascii") as out:
        out.write("[camera]\nposition = %g %g %g\nlook_at = %g %g %g\n" % (*EYE, *TARGET))
        out.write(f"field_deg = {FIELD_DEG}\nwidth = {WIDTH}\nheight = {HEIGHT}\n[render]\nbounces = {BOUNCES}\n")
        out.write("[ground]\n")
        out.write(f"[object things]\nfile = {file}\nup = {'z' if file.endswith('.ply') else 'y'}\n")


def begin():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


def show(scene):
    set_world(scene)
    set_camera(scene)
    set_cycles(scene)
    return add_ground()


def make(name, material, file, tell=None):
    suffix, export = file
    scene = begin()
    nodes = material()
    for thing in add_things({vertex_colours: "POINT", matt_colours: "CORNER"}.get(material)):
        thing.data.materials.append(nodes.material)
    export(os.path.join(HERE, name + suffix))
    write_scene(name, name + suffix)
    if tell:
        tell(nodes)
    show(scene)
    render(scene, name)


def main():
    begin()
    sky()
    show(bpy.context.scene)
    render(bpy.context.scene, "ground")
    with open(os.path.join(HERE, "cases.txt"), "w", encoding="ascii") as out:
        for name, *what in CASES:
            if CHOSEN and name not in CHOSEN:
                continue
            make(name, *what)
            least, why = DIFFERENCES.get(name, (LEAST_DB, ""))
            out.write(f"{name} {least} {why}\n")


main()
