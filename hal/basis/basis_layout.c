#include "hal/basis/basis_layout.h"

static size_t align(size_t bytes)
{
	return (bytes + BASIS_ALIGN - 1) / BASIS_ALIGN * BASIS_ALIGN;
}

struct basis_layout basis_layout(enum basis_kind kind, int pixels, int channels, int lights)
{
	const size_t rows = (size_t)pixels * (size_t)channels;
	struct basis_layout at;

	at.stride = (lights + BASIS_ROW_STEP - 1) / BASIS_ROW_STEP * BASIS_ROW_STEP;
	at.total_channels = kind == BASIS_KIND_V ? 3 : channels;
	at.pixel = 0;
	at.light = align((size_t)pixels * sizeof(uint16_t));
	at.scale = at.light + align((size_t)lights * sizeof(uint16_t));
	at.total = at.scale + align(rows * sizeof(float));
	at.row = at.total + align((size_t)pixels * (size_t)at.total_channels * sizeof(int32_t));
	at.bytes = at.row + rows * (size_t)at.stride * sizeof(int16_t);
	return at;
}
