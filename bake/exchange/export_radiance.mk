
# Renders every picture that is not there yet: make -j4. Each appears when it is whole, so it can be
# interrupted and run again. Of another quality: make QUALITY='-ab 6 -ad 4096 -aa .1'.
# Needs rtrace, oconv, obj2mesh, pcomb and pfilt of Radiance.

# Light that came over other surfaces: how often, by how many rays.
QUALITY = -ab $(BOUNCES) -ad 1024 -as 256 -aa .15 -ar $(RESOLUTION)
# Every sun is asked, wherever in it, and nothing weak is left out.
TRACE = rtrace -h+ -w -ffc -x $(ACROSS) -y $(DOWN) -dt 0 -dc 1 -dj 1 -ds 0 -st 0 -lw .0001 -av 0 0 0 $(QUALITY)
SMALL = pfilt -1 -e 1 -x $(WIDTH) -y $(HEIGHT)
# A picture's own name is the last thing that it gets.
WHOLE = && mv $@.part $@

pictures = $(patsubst %,$(1)%.hdr,$(LIGHTS))

.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all
all: $(call pictures,o) $(call pictures,g) $(call pictures,a)
	@echo 'all there; in this folder:'
	@echo "    $(IMPORT)"

%.rtm: %.obj materials.rad
	obj2mesh -a materials.rad $< $@.part $(WHOLE)
with%.oct: scene.rad light%.rad $(SCENE_MESHES)
	oconv scene.rad light$*.rad > $@.part $(WHOLE)
without%.oct: ground.rad light%.rad $(GROUND_MESHES)
	oconv ground.rad light$*.rad > $@.part $(WHOLE)

a%.wide: with%.oct object.rays
	$(TRACE) $< < object.rays > $@.part $(WHOLE)
s%.wide: with%.oct seen.rays
	$(TRACE) $< < seen.rays > $@.part $(WHOLE)
g%.wide: without%.oct ground.rays
	$(TRACE) $< < ground.rays > $@.part $(WHOLE)

# What is seen of the objects and what is seen of the ground make up both together.
a%.hdr: a%.wide
	$(SMALL) $< > $@.part $(WHOLE)
g%.hdr: g%.wide
	$(SMALL) $< > $@.part $(WHOLE) && rm -f $< without$*.oct
o%.wide: a%.wide s%.wide
	pcomb $^ > $@.part $(WHOLE)
o%.hdr: o%.wide a%.hdr
	$(SMALL) $< > $@.part $(WHOLE) && rm -f a$*.wide s$*.wide o$*.wide with$*.oct
