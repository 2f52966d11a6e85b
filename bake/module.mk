bake_PACKAGES := assimp
bake_LIBS := -lembree3
BAKE_SOURCES :=
BAKE_MAIN := bake/main.c
