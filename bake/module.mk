# LAPACK for the encoder; OpenBLAS is what makes it fast.
bake_PACKAGES := assimp lapacke openblas cairo
# Embree has no pkg-config file. 3.x or 4.x, whichever the compiler finds: bake/world.c does the same.
bake_LIBS := -lembree$(if $(findstring /,$(shell $(CC) -print-file-name=libembree4.so)),4,3)
BAKE_SOURCES := \
	bake/angles.c \
	bake/assembly.c \
	bake/coarse.c \
	bake/encode.c \
	bake/encode_block.c \
	bake/encode_expose.c \
	bake/encode_measure.c \
	bake/encode_part.c \
	bake/encode_plan.c \
	bake/encode_rank.c \
	bake/encode_reader.c \
	bake/encode_search.c \
	bake/encode_shade.c \
	bake/encode_split.c \
	bake/encode_column.c \
	bake/encoding_options.c \
	bake/ensemble.c \
	bake/export_blender.c \
	bake/export_job.c \
	bake/export_mesh.c \
	bake/export_radiance.c \
	bake/export_rays.c \
	bake/bounce.c \
	bake/bounce_aside.c \
	bake/cells.c \
	bake/finished_tile.c \
	bake/import.c \
	bake/import_judge.c \
	bake/import_pictures.c \
	bake/in_order.c \
	bake/keyframes.c \
	bake/material.c \
	bake/mesh.c \
	bake/mesh_files.c \
	bake/mesh_gltf.c \
	bake/mesh_import.c \
	bake/mesh_mtl.c \
	bake/mesh_normals.c \
	bake/mesh_ply.c \
	bake/msi.c \
	bake/options.c \
	bake/peaks.c \
	bake/picture_stack.c \
	bake/pictures.c \
	bake/plain_file.c \
	bake/plan.c \
	bake/progress.c \
	bake/render.c \
	bake/report.c \
	bake/report_bake.c \
	bake/report_choices.c \
	bake/report_error.c \
	bake/report_given.c \
	bake/report_lighting.c \
	bake/report_lights.c \
	bake/report_page.c \
	bake/report_pictures.c \
	bake/report_plot.c \
	bake/report_sky.c \
	bake/report_summary.c \
	bake/report_table.c \
	bake/report_thesis.c \
	bake/report_trial.c \
	bake/scene.c \
	bake/scene_file.c \
	bake/shard.c \
	bake/sight.c \
	bake/sky.c \
	bake/surface.c \
	bake/tile.c \
	bake/tile_glass.c \
	bake/tile_noise.c \
	bake/transport.c \
	bake/truth.c \
	bake/truth_paths.c \
	bake/truth_views.c \
	bake/world.c \
	bake/dome_command.c \
	bake/export_command.c \
	bake/import_command.c \
	bake/info_command.c \
	bake/info_map.c \
	bake/merge_command.c \
	bake/pictures_command.c \
	bake/render_command.c \
	bake/report_command.c \
	bake/truth_command.c
BAKE_MAIN := bake/main.c
# What goes out with a job as it is.
$(BUILD)/bake/export_blender.o: bake/export_blender.py
$(BUILD)/bake/export_radiance.o: bake/export_radiance.mk

# The demo's own object. make-cow is a program apart: it needs no ray tracer.
COW_SOURCES := \
	bake/demo/atlas.c \
	bake/demo/cow_coat.c \
	bake/demo/cow_shape.c \
	bake/demo/implicit.c \
	bake/demo/polygonise.c
BAKE_SOURCES += $(COW_SOURCES)
COW_OBJECTS := $(patsubst %.c,$(BUILD)/%.o,$(COW_SOURCES) bake/demo/make_cow.c)
EXTRA_PROGRAMS += $(BUILD)/make-cow
$(BUILD)/make-cow: $(COW_OBJECTS) $(BUILD)/hal.a
	$(say) LINK $@
	$(Q)$(LINK) $(SHARED_LINK) $(LDFLAGS) -o $@ $^ $(call pkg_libs,$(hal_PACKAGES)) $(hal_LIBS) -lm
-include $(BUILD)/bake/demo/make_cow.d
