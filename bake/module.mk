# SPDX-License-Identifier: MIT
# LAPACK for the encoder; OpenBLAS is what makes it fast.
bake_PACKAGES := libtiff-4 draco lapacke openblas cairo
# Embree and meshoptimizer have no pkg-config file. Embree is 3.x or 4.x, whichever the compiler finds: bake/trace/world.c does the same.
bake_LIBS := -lmeshoptimizer -lembree$(if $(findstring /,$(shell $(CC) -print-file-name=libembree4.so 2>/dev/null)),4,3)
BAKE_SOURCES := \
	bake/dome_command.c \
	bake/info_command.c \
	bake/base/angles.c \
	bake/base/blas.c \
	bake/base/picture_file.c \
	bake/base/pixel_filter.c \
	bake/base/progress.c \
	bake/base/report_page.c \
	bake/base/strata.c \
	bake/base/watch.c \
	bake/encode/encode.c \
	bake/encode/encode_allow.c \
	bake/encode/encode_block.c \
	bake/encode/encode_choose.c \
	bake/encode/encode_column.c \
	bake/encode/encode_fit.c \
	bake/encode/encode_limit.c \
	bake/encode/encode_rank.c \
	bake/encode/encoding_options.c \
	bake/exchange/export_blender.c \
	bake/exchange/export_command.c \
	bake/exchange/export_job.c \
	bake/exchange/export_mesh.c \
	bake/exchange/export_radiance.c \
	bake/exchange/import.c \
	bake/exchange/import_command.c \
	bake/exchange/import_judge.c \
	bake/exchange/import_pictures.c \
	bake/exchange/msi.c \
	bake/exchange/picture_stack.c \
	bake/exchange/pictures.c \
	bake/exchange/pictures_command.c \
	bake/judge/ensemble.c \
	bake/judge/expose.c \
	bake/judge/measure.c \
	bake/judge/part.c \
	bake/judge/reader.c \
	bake/judge/shade.c \
	bake/mesh/coat_energy.c \
	bake/mesh/formats/beside.c \
	bake/mesh/formats/ears.c \
	bake/mesh/formats/mtl.c \
	bake/mesh/formats/obj.c \
	bake/mesh/formats/ply.c \
	bake/mesh/formats/soup.c \
	bake/mesh/formats/stl.c \
	bake/mesh/formats/text.c \
	bake/mesh/formats/textures.c \
	bake/mesh/gltf/accessor.cpp \
	bake/mesh/gltf/document.cpp \
	bake/mesh/gltf/draco.cpp \
	bake/mesh/gltf/geometry.cpp \
	bake/mesh/gltf/gltf.cpp \
	bake/mesh/gltf/materials.cpp \
	bake/mesh/gltf/nodes.cpp \
	bake/mesh/left_out.c \
	bake/mesh/material.c \
	bake/mesh/mesh.c \
	bake/mesh/mesh_normals.c \
	bake/mesh/mesh_used.c \
	bake/mesh/mesh_winding.c \
	bake/mirror/mirror_pixel.c \
	bake/preview/preview_command.c \
	bake/report/report.c \
	bake/report/report_bake.c \
	bake/report/report_command.c \
	bake/report/report_lighting.c \
	bake/report/report_rank.c \
	bake/report/report_show.c \
	bake/report/report_sky.c \
	bake/report/report_trial.c \
	bake/scene/footprint.c \
	bake/scene/keyframes.c \
	bake/scene/scene.c \
	bake/scene/scene_file.c \
	bake/scene/survey.c \
	bake/sky/fine_list.c \
	bake/sky/sky_command.c \
	bake/sky/sky_eye.c \
	bake/sky/sky_need.c \
	bake/sky/sky_parts.c \
	bake/sky/sun.c \
	bake/tiles/assembly.c \
	bake/tiles/coarse.c \
	bake/tiles/finished_tile.c \
	bake/tiles/in_order.c \
	bake/tiles/merge_command.c \
	bake/tiles/peaks.c \
	bake/tiles/plan.c \
	bake/tiles/render.c \
	bake/tiles/render_command.c \
	bake/tiles/shard.c \
	bake/tiles/sight.c \
	bake/tiles/tile.c \
	bake/tiles/tile_glass.c \
	bake/tiles/tile_noise.c \
	bake/tiles/tile_sample.c \
	bake/trace/bounce.c \
	bake/trace/bounce_aside.c \
	bake/trace/cache.c \
	bake/trace/cache_make.c \
	bake/trace/cells.c \
	bake/trace/inside.c \
	bake/trace/transport.c \
	bake/trace/world.c \
	bake/truth/photograph.c \
	bake/truth/sky.c \
	bake/truth/truth.c \
	bake/truth/truth_command.c \
	bake/truth/truth_paths.c \
	bake/truth/truth_views.c
BAKE_MAIN := bake/main.c
# Files that export writes into a job's folder unchanged. x.y becomes the string x_y in the header x.y.h.
$(BUILD)/bake/exchange/%.h: bake/exchange/%
	@mkdir -p $(@D)
	$(Q)(echo 'static const char $(subst .,_,$*)[] ='; sed 's/[\\"]/\\&/g; s/.*/"&\\n"/' $<; echo ';') >$@
$(BUILD)/bake/exchange/export_blender.o: $(BUILD)/bake/exchange/export_blender.py.h
$(BUILD)/bake/exchange/export_radiance.o: $(BUILD)/bake/exchange/export_radiance.mk.h
$(addprefix $(BUILD)/bake/exchange/,export_blender.o export_radiance.o): OWN_FLAGS = -I$(BUILD)
