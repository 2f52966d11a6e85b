"""One picture of each light of a dome, by Cycles on the CPU, for inlay-bake import.

    blender -b -P render.py -- [--samples S] [--size WxH] [--format exr|hdr] [--share I/N]

Reads scene.json, the meshes and angles.txt beside it and writes its pictures there. A picture that is
there already is kept, unless it is older than the job, and one appears when it is whole: run it again after
an interruption, and several times at once with --share. blender -t T limits the threads.
"""

import argparse
import json
import math
import os
import sys
import traceback

import bpy
from mathutils import Matrix

try:
    import numpy
except ImportError:
    sys.exit("render.py: no numpy, which Blender's Python needs here: apt-get install python3-numpy")

HERE = os.path.dirname(os.path.realpath(__file__))
JOB = os.path.join(HERE, "scene.json")
MAP_HEIGHT = 512  # of the pictures of the sky that hold a cell
MAP_HEIGHT_MANY = 1024  # the same of small cells
MANY_LIGHTS = 1000
GLASS_MOST = 32  # surfaces of glass in a row
EDGE = 4  # a texel of them is cut into so many, a side


def options():
    def size(text):
        width, height = text.split("x")
        return int(width), int(height)

    def share(text):
        index, count = (int(word) for word in text.split("/"))
        if not 1 <= index <= count:
            raise ValueError(text)
        return index - 1, count

    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="blender -b -P render.py --")
    parser.add_argument("--samples", type=int, default=256, help="paths a pixel; 256")
    parser.add_argument("--size", type=size, metavar="WxH", help="of the pictures")
    parser.add_argument("--format", choices=("exr", "hdr"), default="exr")
    parser.add_argument("--share", type=share, default=(0, 1), metavar="I/N", help="every N-th light")
    return parser.parse_args(words)


# ---- materials ----


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, material.node_tree.nodes, material.node_tree.links


def load_picture(name):
    picture = bpy.data.images.load(os.path.join(HERE, name))
    picture.colorspace_settings.name = "Non-Color"  # linear as it is
    return picture


def set_colour(socket, values, nodes, links):
    """Of a texture, which is multiplied by the colour already, or of the colour alone, and of vertices."""
    factors = []
    if values["texture"]:
        texture = nodes.new("ShaderNodeTexImage")
        texture.image = load_picture(values["texture"])
        texture.extension = "EXTEND" if values["clamp"] else "REPEAT"
        texture.interpolation = "Closest" if values["nearest"] else "Linear"
        factors.append(texture.outputs["Color"])
    if values.get("coloured"):
        vertices = nodes.new("ShaderNodeAttribute")
        vertices.attribute_name = "colour"
        factors.append(vertices.outputs["Color"])
    if not factors:
        socket.default_value = (*values["colour"], 1)
    elif values["texture"] and len(factors) == 1:
        links.new(factors[0], socket)
    else:
        product = nodes.new("ShaderNodeVectorMath")  # of colours as of vectors
        product.operation = "MULTIPLY"
        product.inputs[0].default_value = product.inputs[1].default_value = values["colour"]
        for place, factor in zip(product.inputs, factors):
            links.new(factor, place)
        links.new(product.outputs[0], socket)


def metal(values, nodes, _links):
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Metallic"].default_value = 1
    shader.inputs["Roughness"].default_value = values["roughness"]
    shader.inputs["Base Color"].default_value = (*values["specular"], 1)
    return shader


def calculate(operation, inputs, nodes, links):
    """Of numbers and of what other nodes say."""
    node = nodes.new("ShaderNodeMath")
    node.operation = operation
    for socket, value in zip(node.inputs, inputs):
        if isinstance(value, bpy.types.NodeSocket):
            links.new(value, socket)
        else:
            socket.default_value = value
    return node.outputs[0]


def glossy(values, nodes, links):
    """A base under a coat, which takes from the base what it mirrors of a sky that is even: Schlick's
    share towards the viewer, r + (1 - r) (1 - cos)^5. That both are summed is what mixing the base
    with nothing is for."""
    coat = metal(values, nodes, links)
    if max(values["colour"]) == 0:
        return coat
    left = 1 - max(values["specular"])
    facing = nodes.new("ShaderNodeLayerWeight")
    facing.inputs["Blend"].default_value = 0.5  # then Facing is 1 - cos
    power = calculate("POWER", (facing.outputs["Facing"], 5), nodes, links)
    base = nodes.new("ShaderNodeMixShader")
    links.new(calculate("MULTIPLY_ADD", (power, -left, left), nodes, links), base.inputs[0])
    links.new(diffuse(values, nodes, links).outputs[0], base.inputs[2])
    both = nodes.new("ShaderNodeAddShader")
    links.new(base.outputs[0], both.inputs[0])
    links.new(coat.outputs[0], both.inputs[1])
    return both


def thin_reflectance(ior, nodes, links):
    """Of both surfaces of a pane and what goes to and fro between them: 2 r / (1 + r)."""
    fresnel = nodes.new("ShaderNodeFresnel")
    # It takes a surface's back for its inside, and the reciprocal there.
    back = nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"]
    power = calculate("MULTIPLY_ADD", (back, -2, 1), nodes, links)
    links.new(calculate("POWER", (ior, power), nodes, links), fresnel.inputs["IOR"])
    twice = calculate("MULTIPLY", (fresnel.outputs[0], 2), nodes, links)
    return calculate("DIVIDE", (twice, calculate("ADD", (fresnel.outputs[0], 1), nodes, links)), nodes, links)


def solid_reflectance(ior, nodes):
    fresnel = nodes.new("ShaderNodeFresnel")
    fresnel.inputs["IOR"].default_value = ior
    return fresnel.outputs[0]


def refraction(ior, values, nodes, links):
    through = nodes.new("ShaderNodeBsdfRefraction")
    through.inputs["IOR"].default_value = ior
    through.inputs["Roughness"].default_value = 0
    set_colour(through.inputs["Color"], values, nodes, links)
    return through.outputs[0]


def straight(values, nodes, links):
    """Lets light through from a cell to a surface. Real things that the camera sees are cut out of the
    picture behind a transparent surface, and seen through one that refracts."""
    mix = nodes.new("ShaderNodeMixShader")
    through = nodes.new("ShaderNodeBsdfTransparent")
    set_colour(through.inputs["Color"], values, nodes, links)
    links.new(nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], mix.inputs[0])
    links.new(through.outputs[0], mix.inputs[1])
    links.new(refraction(1, values, nodes, links), mix.inputs[2])
    return mix.outputs[0]


def glass(values, nodes, links):
    """Tinted by what passes through a surface, or a pane, and not by what it mirrors."""
    mix = nodes.new("ShaderNodeMixShader")
    mirror = nodes.new("ShaderNodeBsdfGlossy")
    mirror.inputs["Roughness"].default_value = 0
    mirror.inputs["Color"].default_value = (1, 1, 1, 1)
    if values["thin"]:
        share = thin_reflectance(values["ior"], nodes, links)
        through = straight(values, nodes, links)
    else:
        share = solid_reflectance(values["ior"], nodes)
        through = refraction(values["ior"], values, nodes, links)
    links.new(share, mix.inputs[0])
    links.new(through, mix.inputs[1])
    links.new(mirror.outputs[0], mix.inputs[2])
    return mix


def diffuse(values, nodes, links):
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    set_colour(shader.inputs["Color"], values, nodes, links)
    return shader


def make_material(name, values):
    material, nodes, links = new_material(name)
    make = {"diffuse": diffuse, "glossy": glossy, "glass": glass}[values["kind"]]
    surface = nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]
    links.new(make(values, nodes, links).outputs[0], surface)
    return material


def make_white():
    """What shines by itself: shows where objects are."""
    material, nodes, links = new_material("white")
    surface = nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]
    links.new(nodes.new("ShaderNodeEmission").outputs[0], surface)
    return material


# ---- meshes ----


def make_object(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def read_mesh(name, materials):
    """Wavefront OBJ as inlay-bake writes it: triangles with a normal at each corner."""
    points, normals, places, colours = [], [], [], []
    faces, face_normals, face_places, face_material = [], [], [], []
    material = 0
    with open(os.path.join(HERE, name), encoding="ascii") as lines:
        for line in lines:
            key, *words = line.split() or ("",)
            if key == "v":
                points.append(tuple(map(float, words[:3])))
                colours.extend((*map(float, words[3:6] or (1, 1, 1)), 1))
            elif key == "vn":
                normals.append(tuple(map(float, words)))
            elif key == "vt":
                places.append(tuple(map(float, words)))
            elif key == "usemtl":
                material = int(words[0][1:])
            elif key == "f":
                corners = [word.split("/") for word in words]
                faces.append([int(c[0]) - 1 for c in corners])
                face_places.extend(places[int(c[1]) - 1] for c in corners)
                face_normals.extend(normals[int(c[2]) - 1] for c in corners)
                face_material.append(material)
    thing = make_object(name, points, faces)
    mesh = thing.data
    for entry in materials:
        mesh.materials.append(entry)
    mesh.polygons.foreach_set("material_index", face_material)
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    uv = mesh.uv_layers.new(name="uv")
    uv.data.foreach_set("uv", [value for place in face_places for value in place])
    vertices = mesh.attributes.new(name="colour", type="FLOAT_COLOR", domain="POINT")
    vertices.data.foreach_set("color", colours)
    if hasattr(mesh, "use_auto_smooth"):  # up to Blender 4.0; later ones always do
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set(face_normals)
    mesh.update()
    return thing


def make_ground(values):
    reach = values["reach"]
    if values["round"]:
        corners = [
            (reach * math.cos(k * math.pi / 128), reach * math.sin(k * math.pi / 128), 0) for k in range(256)
        ]
    else:
        corners = [(-reach, -reach, 0), (reach, -reach, 0), (reach, reach, 0), (-reach, reach, 0)]
    ground = make_object("ground", corners, [list(range(len(corners)))])
    look = {"kind": "diffuse", "colour": values["albedo"], "texture": None}
    ground.data.materials.append(make_material("ground", look))
    return ground


# ---- camera ----


def set_camera(scene, values, size):
    """A pinhole: focal lengths and centre in pixels, x right and y up from the lower left."""
    width, height = size or values["size"]
    across, down = width / values["size"][0], height / values["size"][1]
    fx, fy = values["focal"][0] * across, values["focal"][1] * down
    cx, cy = values["centre"][0] * across, values["centre"][1] * down
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.pixel_aspect_x = max(fy / fx, 1)
    scene.render.pixel_aspect_y = max(fx / fy, 1)
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = 36
    data.lens = fx * data.sensor_width / width
    data.shift_x = 0.5 - cx / width
    data.shift_y = (height / 2 - cy) / width * (fx / fy)
    data.clip_start, data.clip_end = values["clip"]
    r, eye = values["rotation"], values["position"]
    # Tsai's axes are x right, y down, z ahead; Blender's x right, y up, z back
    camera.matrix_world = Matrix(
        [[r[k], -r[3 + k], -r[6 + k], eye[k]] for k in range(3)] + [[0, 0, 0, 1]]
    )


# ---- lights ----


def read_angles():
    with open(os.path.join(HERE, "angles.txt"), encoding="ascii") as lines:
        angles = numpy.array([[float(word) for word in line.split()] for line in lines])
    theta, phi = angles[:, 0], angles[:, 1]
    return numpy.stack((numpy.sin(theta) * numpy.cos(phi), numpy.sin(theta) * numpy.sin(phi), numpy.cos(theta)))


class Sky:
    """The world: one cell of radiance 1 at a time. A cell is what is nearer to its light than to others."""

    def __init__(self, scene):
        directions = read_angles().astype(numpy.float32)
        self.lights = directions.shape[1]
        self.height = MAP_HEIGHT_MANY if self.lights > MANY_LIGHTS else MAP_HEIGHT
        self.width = 2 * self.height
        self.nearest = self.find_nearest(directions)
        self.world = bpy.data.worlds.new("sky")
        self.world.use_nodes = True
        nodes, links = self.world.node_tree.nodes, self.world.node_tree.links
        nodes.clear()
        self.texture = texture = nodes.new("ShaderNodeTexEnvironment")
        texture.interpolation = "Closest"
        background = nodes.new("ShaderNodeBackground")
        links.new(texture.outputs["Color"], background.inputs["Color"])
        links.new(background.outputs[0], nodes.new("ShaderNodeOutputWorld").inputs["Surface"])
        self.world.cycles.sampling_method = "MANUAL"
        self.world.cycles.sample_map_resolution = self.width
        self.world.cycles_visibility.camera = False
        scene.world = self.world

    def find_nearest(self, directions):
        """The light of each part of each texel of the upper half, rows from the horizon."""
        columns, rows = self.width * EDGE, self.height * EDGE // 2
        phi = (0.5 - (numpy.arange(columns) + 0.5) / columns) * 2 * math.pi
        nearest = numpy.empty((rows, columns), numpy.int32)
        for row in range(rows):
            up = (row + 0.5) / rows * math.pi / 2
            look = (math.cos(up) * numpy.cos(phi), math.cos(up) * numpy.sin(phi), numpy.full(columns, math.sin(up)))
            nearest[row] = (numpy.stack(look, 1).astype(numpy.float32) @ directions).argmax(1)
        return nearest

    def show(self, light):
        half = self.height // 2
        cell = numpy.zeros((self.height, self.width, 4), numpy.float32)
        parts = (self.nearest == light).reshape(half, EDGE, self.width, EDGE)
        cell[half:, :, :3] = parts.mean((1, 3))[:, :, None]
        cell[:, :, 3] = 1
        # a picture that is changed in place is not seen to have changed
        old = self.texture.image
        new = bpy.data.images.new("cell", self.width, self.height, float_buffer=True, is_data=True)
        new.pixels.foreach_set(cell.ravel())
        self.texture.image = new
        if old:
            bpy.data.images.remove(old)


# ---- pictures ----


def set_cycles(scene, samples, bounces, has_glass):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.light_sampling_threshold = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    # what passes glass is no bounce of the scene's
    cycles.max_bounces = cycles.transmission_bounces = bounces + (GLASS_MOST if has_glass else 0)
    cycles.transparent_max_bounces = GLASS_MOST
    scene.render.film_transparent = True
    scene.render.use_persistent_data = True
    scene.view_settings.view_transform = "Raw"
    scene.view_settings.look = "None"
    scene.view_settings.exposure, scene.view_settings.gamma = 0, 1


def set_format(scene, name):
    settings = scene.render.image_settings
    settings.file_format = {"exr": "OPEN_EXR", "hdr": "HDR"}[name]
    settings.color_mode = "RGB"
    if name == "exr":
        settings.color_depth = "32"
        settings.exr_codec = "ZIP"
    scene.render.use_file_extension = False


def render(scene, path):
    """Not there, half: under another name until it is whole."""
    part = f"{path}.{os.getpid()}.part"
    scene.render.filepath = part
    bpy.ops.render.render(write_still=True)
    os.replace(part, path)


def main():
    said = options()
    with open(JOB, encoding="ascii") as text:
        job = json.load(text)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    has_glass = any(values["kind"] == "glass" for values in job["materials"])
    set_cycles(scene, said.samples, job["bounces"], has_glass)
    set_format(scene, said.format)
    set_camera(scene, job["camera"], said.size)
    materials = [make_material(f"m{k}", values) for k, values in enumerate(job["materials"])]
    objects = [read_mesh(name, materials) for name in job["objects"]]
    real = [read_mesh(name, materials) for name in job["standins"]]
    if job["ground"]:
        real.append(make_ground(job["ground"]))
    sky = Sky(scene)

    def show(with_objects, with_real):
        for thing in objects:
            thing.hide_render = not with_objects
        for thing in real:
            thing.is_holdout = not with_real

    def picture(what, number=None):
        name = job["pictures"][what]
        name = name if number is None else name % number
        return os.path.join(HERE, f"{name}.{said.format}")

    def is_there(path):  # and was rendered from this job, not from the one before in this folder
        return os.path.exists(path) and os.path.getmtime(path) >= os.path.getmtime(JOB)

    passes = {"object": (True, True), "ground": (False, True), "alone": (True, False)}
    index, count = said.share
    for what, shown in passes.items():
        show(*shown)
        for light in range(index, sky.lights, count):
            if is_there(picture(what, light)):
                continue
            sky.show(light)
            scene.cycles.seed = light  # the same of all passes: what is seen twice has the same noise
            render(scene, picture(what, light))
    if index == 0 and not is_there(picture("coverage")):
        show(True, False)
        scene.view_layers[0].material_override = make_white()
        scene.world = None
        render(scene, picture("coverage"))
    print("when all are there, in this folder:")
    print("    " + job["import"].replace(".exr", "." + said.format))


# Blender itself takes a script that failed for one that is done.
try:
    main()
except OSError as fault:
    sys.exit(f"render.py: {fault}")
except Exception:
    traceback.print_exc()
    sys.exit(1)
