/* Where the kernel's text tells a recorder what it does. Nothing, unless the includer defines
 * CT_RECORDS: then these are functions of record.inc.h, which it includes after the kernel. The
 * plain kernels hence pay nothing, and the recorder traces by the very same text. */
#ifndef CT_RECORDS
#define ON_RAY(world, pixel, ray, hit) ((void)0)
#define RETURNED(pixel, split, color) (color)
#define ON_LIGHT(world, pixel, hit, j, cosine, lit, diffuse, is_specular, shine) ((void)0)
#define ON_FEELER(world, pixel, ray, hit, j, origin, direction, limit) ((void)0)
#define ON_SCATTER(world, pixel, ray, hit, scatter) ((void)0)
#define ON_BRANCH(pixel, kind, factor) ((void)0)
#define ON_UNSENT(pixel, color) ((void)0)
#else
#include "recorder.h"

/* A ray has been traced to its hit; and all that it returns is known. */
#define ON_RAY(world, pixel, ray, hit) \
  const ct_open_ray parent_ray = record_ray(world, pixel, ray, hit)
#define RETURNED(pixel, split, color) record_return(pixel, &parent_ray, split, color)
/* What light j is about to add to a hit, before it is asked whether anything blocks it. */
#define ON_LIGHT record_light
#define ON_FEELER record_feeler
/* The side and the total reflection of a hit are decided. */
#define ON_SCATTER record_scatter
/* A secondary ray of that weight comes next; or none is sent, and that colour stands for it. */
#define ON_BRANCH record_branch
#define ON_UNSENT record_unsent

typedef struct FN(scatter) FN(scatter);
static ct_open_ray record_ray(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit);
static VEC record_return(ct_pixel *pixel, const ct_open_ray *parent, const SPLIT *split,
                         VEC color);
static void record_light(const WORLD *world, ct_pixel *pixel, const HIT *hit, size_t j,
                         REAL cosine, int lit, VEC diffuse, int is_specular, REAL shine);
static void record_feeler(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                          size_t j, VEC origin, VEC direction, REAL limit);
static void record_scatter(const WORLD *world, ct_pixel *pixel, const RAY *ray, const HIT *hit,
                           const FN(scatter) *scatter);
static void record_branch(ct_pixel *pixel, ct_ray_kind kind, REAL factor);
static void record_unsent(ct_pixel *pixel, VEC color);
#endif
