/* SPDX-License-Identifier: MIT */
/* The parts of camera_sim.c. */
#ifndef INLAY_DRIVERS_SIM_SIM_H
#define INLAY_DRIVERS_SIM_SIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/device/camera.h"
#include "hal/frame/frame.h"
#include "hal/ini/ini.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

/*
 * Lamps on mains flicker at twice its frequency f, and a rolling shutter shows that as rows. The
 * light of a lamp over its mean, and what a row that is exposed from t to t + shutter sees of it:
 *
 *     l(t)   = 1 + depth cos(4 pi f t)
 *     row(t) = 1 + depth sinc(2 f shutter) cos(4 pi f (t + shutter / 2))
 *     sinc(x) = sin(pi x) / (pi x)
 *
 * Row y of `height` begins to be exposed readout * y / height after the frame.
 */

struct mains {
	double depth; /* 0..1; 0: lamps do not flicker */
	double hz;    /* f */
	double shutter_s, readout_s;
};

/* What a row of a frame that begins at time_s sees of a lamp, over the lamp's mean. */
double mains_row(const struct mains *mains, double time_s, int y, int height);

/*
 * People who walk through the studio: who they are and where they go. Bodies are made of capsules
 * (walker_body.h); studio_people.h draws them.
 *
 * Each walker crosses the room along x every 10 to 12 s, before the object, behind it or through
 * its place, and is not there in between: it comes and goes through the walls, out of sight of a
 * camera that looks along y. All is a function of time.
 */

/* Who they are, in the order in which sim.walkers lets them in. */
enum walker_style {
	WALKER_JUMPER, /* striped */
	WALKER_SUIT,   /* dark */
	WALKER_CHECKS, /* checked shirt */
	WALKER_CHILD,  /* small, in yellow */
	WALKER_RUG,    /* in the colour of the rug that the object stands on, without texture */
	WALKER_BAG,    /* carries a bag, and leaves it standing until the next crossing */
	WALKER_STYLES
};

struct walker {
	enum walker_style style;
	double place[2];    /* on the ground, m */
	double heading_rad; /* of the walk, from +X towards +Y */
	double walked;	    /* strides (of two steps); its fraction is the phase of the legs */
	double pace;	    /* 0: stands, feet side by side; 1: walks */
	double time_s;	    /* who stands sways a little */
	bool bag_in_hand;   /* of WALKER_BAG */
	bool bag_left;
	double bag_place[2]; /* if it is left */
	bool absent;	     /* only the bag is there */
	double height;	     /* see walker_height(); 0: the style's */
	/* Albedos of skin, hair, top, legs, shoes and bag, under the style's pattern; NULL: the
	 * style's. */
	const double (*cloth)[3];
};

/* Lists who, and whose bag, is in the room at a time. Returns their number, at most count. */
int walkers_at(double time_s, int count, struct walker list[WALKER_STYLES]);

/* Height of a walker of this style against a grown person's, who is about 1.75 m tall; a stride is
 * WALKER_STRIDE_M long at height 1. */
double walker_height(enum walker_style style);
#define WALKER_STRIDE_M 1.35

/*
 * The body of a walker at a moment: capsules (all points within a radius of a line), some of them
 * widened from side to side, so that rays meet them in closed form. The feet follow a walk: one
 * stands still on the ground while the other swings forward; knees and elbows bend as the distances
 * want.
 */

enum { WALKER_PARTS = 24 };

enum walker_cloth { CLOTH_SKIN, CLOTH_HAIR, CLOTH_TOP, CLOTH_LEGS, CLOTH_SHOES, CLOTH_BAG };

struct walker_part {
	enum walker_cloth cloth;
	double from[3], along[3]; /* the line: from, and from + along */
	double radius;
	double widen; /* in the direction of side: its half-width there is radius * widen */
};

struct walker_body {
	enum walker_style style;
	const double (*cloth)[3]; /* as the walker's */
	double side[3], ahead[3]; /* unit vectors: to the left, and where it walks */
	int count;
	struct walker_part part[WALKER_PARTS];
	double low[3], up[3], reach; /* an upright capsule that holds all: its line and radius */
};

void walker_pose(const struct walker *walker, struct walker_body *body);

struct walker_hit {
	int part;
	double distance; /* in units of dir's length */
	double normal[3];
	double albedo[3];
};

/* Finds the nearest of the parts whose bits are set. dir is a unit vector. False: none is hit. */
bool walker_hit(const struct walker_body *body, unsigned parts, const double origin[3],
		const double dir[3], struct walker_hit *hit);

/* The parts that a cone may touch: every ray from origin within an angle of dir. */
unsigned walker_in_cone(const struct walker_body *body, const double origin[3], const double dir[3],
			double angle_rad);

/*
 * The share of a round piece of a lamp, of this radius, that the body hides from a point: 0..1.
 * Each part hides of the beam's width what its own width covers. Parts overlap in part: the result
 * is the mean of the largest share and of 1 - product of (1 - share). Edges of the shadow are so as
 * soft as the lamp is wide, without samples; against dense rays it is off by 0.1 (RMS) in the
 * penumbra.
 */
double walker_hides(const struct walker_body *body, const double point[3], const double lamp[3],
		    double radius);

/*
 * The studio: a simulated room whose radiance along any ray, at any time, has a closed form. It
 * serves as ground truth for tests.
 *
 * World units are metres. The room is the box |x| <= 3, |y| <= 2.5, 0 <= z <= 3. Its floor is the
 * ground z = 0; the object stands at the origin. Two ceiling panels, which can be switched, and a
 * window are steady light sources; two paper lanterns, one warm and one cool, move on smooth paths.
 * Emitters have constant radiance L. A diffuse surface has the radiance
 *
 *     L_out = albedo / pi * (sum of E over all emitters + constant)
 *
 * with the irradiance E of
 *
 *     a lantern (sphere of radius r)   E = pi * L * (r / d)^2 * cos(theta)
 *     a rectangle (Lambert)            E = L / 2 * |sum over edges of angle * dot(edge normal, n)|
 *
 * d is the distance and theta the angle of incidence. The edge normal is the unit normal of the
 * plane through the point and an edge, n that of the surface. The constant stands for light from
 * all other surfaces. Nothing in the room casts shadows; walkers.h adds what does. Radiance 1 is
 * white at exposure 1: the floor is mid-grey, lanterns are about 4.
 */

enum { STUDIO_LANTERNS = 2 };

enum studio_surface {
	STUDIO_FLOOR,
	STUDIO_CEILING,
	STUDIO_WALL_EAST,  /* x = 3 */
	STUDIO_WALL_WEST,  /* the one with the window */
	STUDIO_WALL_NORTH, /* y = 2.5 */
	STUDIO_WALL_SOUTH,
	STUDIO_SURFACE_COUNT
};

struct studio_lantern {
	double centre[3], radius, radiance[3];
};

/* The lamps at a moment. */
struct studio_lamps {
	struct studio_lantern lantern[STUDIO_LANTERNS];
	double panels; /* factor of the ceiling panels' radiance: 1 on, 0 off */
	/* The panels flicker in a view of the studio (studio_view.h); all else has their mean. */
	struct mains mains;
	double time_s;
};

/* The point where a ray leaves the room, without regard to lanterns. */
struct studio_hit {
	enum studio_surface surface;
	double distance; /* along a unit direction */
	double point[3];
	double emitted[3]; /* radiance of a panel that is on or of the window; albedo is 0 */
	double albedo[3];
};

extern const double studio_normals[STUDIO_SURFACE_COUNT][3]; /* they point into the room */

/* Returns the lamps at a time. switch_s: the panels go off, and on again, every so many seconds; 0:
 * they stay on. */
struct studio_lamps studio_lamps(double time_s, double switch_s);

/* Finds where a ray leaves the room. dir is a unit vector. For an origin outside, the walls that
 * face the viewer are transparent. False: the ray misses the room. */
bool studio_hit(const double origin[3], const double dir[3], struct studio_hit *hit);

/* Computes the irradiance at a point of a surface by everything but the lanterns. panels: see
 * struct studio_lamps. */
void studio_steady_irradiance(const double point[3], enum studio_surface surface, double panels,
			      double rgb[3]);

/* Returns the irradiance by a lantern for a radiance of 1. */
double studio_lantern_irradiance(const struct studio_lantern *lantern, const double point[3],
				 const double normal[3]);

/* A small piece of a lamp, for what its light does off the room's surfaces: the irradiance is
 *
 *     E = power cos(theta) cos(theta') / d^2
 *
 * with theta' the angle at the lamp, whose cosine counts as 1 for a lantern (facing is 0). */
struct studio_piece {
	double place[3], facing[3], power[3];
	double radius; /* of the piece, m */
};

enum { STUDIO_PIECES = 3 + 3 + 4 + STUDIO_LANTERNS };

/* Divides the lamps: panels into three, the window into four, lanterns are one each. */
void studio_pieces(const struct studio_lamps *lamps, struct studio_piece piece[STUDIO_PIECES]);

/* Light from all other surfaces, which is the same everywhere. */
extern const double studio_ambient_irradiance[3];

/* Returns the nearest lantern that a ray hits within a distance of `limit`; -1: none. dir is a unit
 * vector. */
int studio_lantern_hit(const struct studio_lamps *lamps, const double origin[3],
		       const double dir[3], double limit);

/* Hashes a pair of integers to a number in 0..1. */
double studio_chance(uint32_t a, uint32_t b);

/* Computes the radiance that arrives at origin from the unit vector dir; 0 if the ray misses the
 * room. */
void studio_radiance(const double origin[3], const double dir[3], const struct studio_lamps *lamps,
		     double rgb[3]);

/* The position and projection of a simulated camera: the ray of each pixel. */

struct sim_eye {
	int width, height;
	bool fisheye;
	struct fisheye lens;	   /* if fisheye */
	double position[3];	   /* if fisheye; m */
	struct tsai_camera camera; /* if not fisheye */
};

/* Computes the ray of a point in the picture; dir is a unit vector. False: the point lies outside
 * the field of view. */
bool eye_ray(const struct sim_eye *eye, const double px[2], double origin[3], double dir[3]);

/* Returns the approximate angular width of a pixel at a point, in rad: the mean of its two sides. 0
 * outside the field of view. */
double eye_pixel_rad(const struct sim_eye *eye, const double px[2]);

/* Whether the rim of a fisheye's image circle crosses a pixel, part of which then sees nothing. */
bool eye_on_rim(const struct sim_eye *eye, int x, int y);

/* The ray of a pixel's middle of a camera that is no fisheye; returns how much farther along the
 * camera's axis it is for each metre along the ray, 0: there is no ray. */
double eye_along_axis(const struct sim_eye *eye, int x, int y, double origin[3], double dir[3]);

/*
 * Renders the studio as a camera sees it, fast enough for video. Rays, albedo and steady light are
 * computed once for each pixel, with anti-aliasing; each frame adds the lanterns.
 */

struct studio_view;

/* Computes everything that does not move; the caller destroys *view. 0 or -ENOMEM. */
int studio_view_create(struct studio_view **view, const struct sim_eye *eye);

/* Computes the mean radiance of each pixel: rgb[height][width][3]. */
void studio_view_render(const struct studio_view *view, const struct studio_lamps *lamps,
			float *rgb);

/* What a pixel sees of the room. */
struct studio_ground {
	double point[3], normal[3]; /* of its first sample */
	double paint[3];	    /* mean albedo / pi over the pixel */
};

struct studio_ground studio_view_ground(const struct studio_view *view, int x, int y);
const struct sim_eye *studio_view_eye(const struct studio_view *view);

/* Multiplies the light of a pixel that sees surfaces alone, no source of light. */
void studio_view_paint(struct studio_view *view, int x, int y, const double factor[3]);

void studio_view_destroy(struct studio_view *view); /* NULL is harmless */

/* Computes the depth of the empty room along the axis of a camera that is no fisheye,
 * z[height][width] in m; 0: a lantern, which blinds a depth camera. */
void studio_view_depth(const struct studio_view *view, const struct studio_lamps *lamps, float *z);

/*
 * Walkers (walkers.h) in the studio as a camera sees it: bodies, and the shadows that they cast.
 *
 * A body is drawn by SIDE x SIDE rays a pixel; its light is that of all pieces of lamps
 * (studio_pieces()) and the ambient one, with its own normal. Approximations:
 *   - shadows fall on the room only, not on bodies; a body sends no light back to the room;
 *   - a shadow is the share of each piece that walker_hides() gives, so its edges are as soft as
 *     the lamp but not exact; it is computed for every fourth pixel and row, and between them
 *     interpolated; of the ambient light seven wide beams are tested;
 *   - a walker does not hide or darken the lanterns that shine behind.
 */

/* Takes from rgb[height][width][3], the empty studio, the light that walkers keep from it. */
void studio_people_shade(const struct studio_view *view, const struct studio_lamps *lamps,
			 const struct walker *walkers, int count, float *rgb);

/* A layer of bodies over the room. */
struct studio_layer {
	float rgb[3]; /* premultiplied by alpha */
	float alpha;  /* share of the pixel that bodies cover */
	float depth;  /* m along the ray through the middle of what is covered; 0: nothing is */
	int walker;   /* the one that covers most of it; -1: none */
};

/* Draws the bodies of some walkers: layer[height][width]. */
void studio_people_draw(const struct studio_view *view, const struct studio_lamps *lamps,
			const struct walker *walkers, int count, struct studio_layer *layer);

/* Puts a layer over rgb[height][width][3]. */
void studio_people_over(const struct studio_view *view, const struct studio_layer *layer,
			float *rgb);

/* Puts a layer over the depths of studio_view_depth(), where it covers half of a pixel. */
void studio_people_depth(const struct studio_view *view, const struct studio_layer *layer,
			 float *z);

/*
 * Renders an HDR panorama, turned about the vertical axis, as a camera sees it. Each pixel is the
 * mean of bilinear samples, one for each panorama pixel that it covers, at most 4x4.
 */

struct panorama_view;

/* Reads the panorama and computes the samples of every pixel. The file must hold linear light,
 * twice as wide as high. The caller destroys *view. 0 or -errno with a fault. */
int panorama_view_create(struct panorama_view **view, const char *path, const struct sim_eye *eye,
			 struct fault *fault);

/* Renders rgb[height][width][3]. The panorama is turned by turn_rad, counter-clockwise from
 * above. */
void panorama_view_render(const struct panorama_view *view, double turn_rad, float *rgb);

void panorama_view_destroy(struct panorama_view *view); /* NULL is harmless */

/*
 * Reads YUV4MPEG2 video from a file or a pipe: 8-bit 4:2:0, 4:2:2, 4:4:4 and grey.
 *
 * A pipe is read without blocking, except that opening waits for its header, at most 2 s. Frames of
 * interlaced video are not deinterlaced.
 */

enum y4m_chroma { Y4M_420, Y4M_422, Y4M_444, Y4M_GREY };

struct y4m {
	char path[INI_PATH_MAX];
	int fd; /* -1: closed */
	bool pipe;
	int width, height;
	double rate_hz; /* 0: not known */
	enum y4m_chroma chroma;
	enum colour_range range; /* limited unless the header says FULL */
	int64_t first_frame;	 /* offset in the file */
	uint8_t *picture;	 /* planes, one after the other */
	size_t picture_bytes;
	char line[256];			/* a header line, perhaps not whole yet */
	size_t line_have, picture_have; /* bytes read so far */
	bool in_picture;
};

/* Opens the video and reads its header. 0 or -errno with a fault; -ETIMEDOUT: the pipe sent
 * none. */
int y4m_open(struct y4m *video, const char *path, struct fault *fault);

/* Reads the next picture. 0; -EAGAIN: the pipe has no whole one yet; -ENODATA: the end (no fault);
 * -EBADMSG: the data is damaged or cut short. */
int y4m_next(struct y4m *video, struct fault *fault);

/* Goes back to the first picture; files only. */
int y4m_rewind(struct y4m *video, struct fault *fault);

/* Converts the picture read last; the canvas has the video's size. */
void y4m_decode(const struct y4m *video, enum colour_matrix matrix, enum colour_range range,
		struct canvas *canvas);

void y4m_close(struct y4m *video); /* idempotent; needs fd -1 or opened */

/*
 * Plays pictures from files:
 *
 *     img%03d.png    numbered pictures, from 0 or 1 on, until one is missing
 *     clip.y4m       Y4M video; a named pipe or /dev/stdin plays as its bytes arrive
 *     room.png       one picture for ever
 *
 * All pictures have one size and kind: 8-bit code values, or linear light (.hdr, .pfm, .exr).
 */

struct player;

struct player_settings {
	const char *path;
	bool loop;
	int matrix, range; /* as in camera_settings; used for Y4M only */
};

/* The present picture. The player owns the memory; it is valid until player_next(). */
struct player_picture {
	int width, height;
	double rate_hz;	     /* 0: not known */
	int descriptor;	     /* of a pipe, for poll(); -1: pictures are always ready */
	const uint8_t *bgrx; /* rows of width * 4 bytes; NULL: the pictures are linear */
	const float *linear; /* RGB; NULL: the pictures are 8-bit */
};

/* Opens the files; the caller closes *player. 0 or -errno with a fault; -ETIMEDOUT: a pipe sent no
 * header. */
int player_open(struct player **player, const struct player_settings *settings,
		struct fault *fault);

/* Advances by `steps` >= 1 pictures and decodes the new one; the first call with 1 gives the first
 * picture. 0; -EAGAIN: a pipe has no whole picture yet; -ENODATA: the end, if not looped. */
int player_next(struct player *player, uint64_t steps, struct fault *fault);

struct player_picture player_picture(const struct player *player);

void player_close(struct player *player); /* NULL is harmless */

/*
 * A simulated sensor: converts linear light to the code values of a camera.
 *
 *     v    = exposure * gain * radiance + noise   clipped to 0..1
 *     code = black + (255 - black) * transfer(v)  rounded
 *
 * The noise is Gaussian, with a standard deviation of
 *
 *     sigma = sqrt(read^2 + shot^2 * exposure * gain * radiance)
 *
 * read and shot are given in 8-bit levels of linear light. The same seed and frame give the same
 * noise.
 */

struct sensor_settings {
	double exposure;
	enum transfer transfer;
	int black_level;
	double read_noise, shot_noise;
	int seed;
};

struct sensor {
	struct sensor_settings settings;
	float gain[3];	       /* of R, G, B; 1 until it is set */
	uint8_t encode[65536]; /* code value of i / 65535 of linear light */
};

void sensor_prepare(struct sensor *sensor, const struct sensor_settings *settings);

/* Converts a frame of linear light, rgb[count][3], to BGRX. frame selects the noise. */
void sensor_expose(const struct sensor *sensor, uint64_t frame, const float *rgb, size_t count,
		   uint8_t *bgrx);

/* Converts BGRX to YUYV; chroma is the mean of each pair of pixels. Neither has padding; the width
 * is even. */
void sensor_pack_yuyv(const uint8_t *bgrx, size_t pixels, enum colour_matrix matrix,
		      enum colour_range range, uint8_t *yuyv);

/*
 * A depth camera that triangulates: depths z in m become mm,
 *
 *     measured = z + noise z^2 gauss    rounded; noise: the standard deviation in mm at 1 m
 *
 * 0, not known: where z is 0 or beyond 65.534 m, and where a neighbour is nearer or farther by a
 * tenth, because at edges one of the two eyes sees something else.
 */
struct sensor_depth {
	double noise_mm;
	int seed;
};

/* Measures z[height][width] as words[height][width] of PIXEL_Z16; frame selects the noise. */
void sensor_measure(const struct sensor_depth *sensor, uint64_t frame, const float *z, int width,
		    int height, uint8_t *words);

/*
 * The edge spread of a simulated camera: linear light is convolved with the Gaussian of discrete
 * places (Lindeberg 1990), whose variance is sigma^2 at any sigma, cut off beyond four sigma:
 *
 *     w(n) = exp(-sigma^2) I_n(sigma^2)    I_n: modified Bessel function
 *
 * Pixels are means over their squares already, so that a straight edge becomes their box convolved
 * with the Gaussian, as `edge_spread` of a camera file means it (hal/optics/tsai.h). Beyond the
 * picture's border its outermost pixels go on.
 */

#define SPREAD_MAX_PX 8.0

/* Blurs rgb[height][width][3] into to, through scratch; all three are of one size and none is
 * another. 0 < sigma_px <= SPREAD_MAX_PX. */
void spread_edges(const float *rgb, int width, int height, double sigma_px, float *scratch,
		  float *to);

/*
 * Automatic exposure and white balance of a simulated camera. Each frame's gains follow the frames
 * before it, as a real camera's do, and the first frame finds them settled. In stops s of a channel
 * whose mean light is M, exposure times radiance,
 *
 *     wanted = log2(level / mean of M over R, G, B)    exposure
 *     wanted = log2(M_G / M)                           white balance (grey world), of R and B
 *     s     += (1 - exp(-period / time)) (wanted - s)
 *     gain   = 2^(exposure's s + white balance's s)    each s rounded to a multiple of step
 */

struct automatic_settings {
	double level; /* mean linear light that exposure wants, white is 1; 0: it stays */
	bool white;
	double time_s;	   /* time constant; 0: at once */
	double step_stops; /* 0: no steps */
};

struct automatic {
	struct automatic_settings settings;
	double exposure, white[3]; /* s, in stops */
	bool begun;
};

/* Meters a frame, radiance rgb[count][3], and returns the gains of R, G and B at which it is taken:
 * those that the frames before have set. */
void automatic_gain(struct automatic *automatic, const float *rgb, size_t count, double exposure,
		    double period_s, float gain[3]);

/* The keys of the simulated camera, [camera NAME] sim.*, and the eye that they describe. */

enum sim_source { SIM_SOURCE_STUDIO, SIM_SOURCE_PANORAMA, SIM_SOURCE_FILES };
enum sim_view { SIM_VIEW_FISHEYE, SIM_VIEW_PERSPECTIVE };
enum sim_clock { SIM_CLOCK_REAL, SIM_CLOCK_FRAMES };

struct sim_options {
	int source, view, pace;
	char file[INI_PATH_MAX];
	char camera[INI_PATH_MAX];
	double eye[3], target[3], angle_deg;
	double position[3];
	struct fisheye_settings lens;
	double turn_rate_deg;
	double switch_s;
	int walkers;
	double exposure;
	int transfer;
	double read_noise, shot_noise;
	double edge_spread_px;
	struct automatic_settings automatic;
	struct mains mains;
	int black_level;
	double depth_noise_mm;
	int seed;
	bool loop;
	int stall_after, vanish_after, corrupt_every;
	int control_delay, warm_up;
};

#define SIM_EXPOSURE_MAX 1e6 /* limit of the exposure, as a key and as a control */
#define SIM_DELAY_MAX 30     /* limit of control_delay, in frames */

extern const struct ini_key sim_keys[];

/* Prepares the eye. Its size is that of the settings, else that of the camera file, else 640x480.
 * 0; -errno: the camera file cannot be read, or does not fit the size. */
int sim_eye(const struct sim_options *options, const struct camera_settings *settings,
	    struct sim_eye *eye, struct fault *fault);

#endif
