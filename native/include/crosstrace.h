/* crosstrace: the native reference tracer for the course's scene format.
 *
 * A scene is its float64 numbers (ct_scene_view, plain data that the caller owns); text becomes a
 * ct_scene, whose view the caller may read. Rendering borrows a view, never copies or changes it.
 *
 * Contracts that hold for every function here:
 *   - nothing prints, exits, or keeps state between calls; calls on different objects may run at
 *     the same time in different threads;
 *   - the floating-point state of the calling thread (rounding mode, flush-to-zero) is set to the
 *     IEEE default during the call and given back as it was;
 *   - the same view and options give the same bits, whatever the number of threads.
 */
#ifndef CROSSTRACE_H
#define CROSSTRACE_H

#include <stddef.h>
#include <stdint.h>

/* The library is built with hidden visibility; only what carries this mark is exported. */
#if defined(__GNUC__)
#define CT_API __attribute__((visibility("default")))
#else
#define CT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ct_status {
  CT_OK = 0,
  CT_ERR_MEMORY,    /* an allocation failed */
  CT_ERR_SCENE,     /* malformed or meaningless scene: see the ct_fault */
  CT_ERR_OPTION,    /* unknown reading, value or precision: see the ct_fault */
  CT_ERR_ARGUMENT,  /* a null pointer or an impossible range where one is not allowed */
  CT_ERR_CANCELLED, /* the progress callback asked to stop */
  CT_ERR_BUDGET,    /* the ray budget is used up */
  CT_ERR_DEPTH,     /* a ray tree deeper than ct_max_tree_depth() */
  CT_ERR_THREAD     /* a thread could not be started */
} ct_status;

CT_API const char *ct_status_text(ct_status status);
CT_API const char *ct_version(void);

/* ---- Scenes ---- */

enum { CT_SPHERE = 0, CT_PLANE = 1 };
enum { CT_KA, CT_KD, CT_KS, CT_ETA, CT_KR, CT_KT, CT_N, CT_MATERIAL_COLUMNS };
enum { CT_GEOMETRY_COLUMNS = 6, CT_LIGHT_COLUMNS = 6 };

/* What is wrong with a scene or an option. Lines and columns count from 1 (0: not from text);
 * columns count characters of UTF-8. `where` names the field: "objects[3].radius". Texts end in 0. */
typedef struct ct_fault {
  size_t line, column;
  char where[64];
  char expected[160];
  char found[96];
} ct_fault;

/* A scene as plain data, borrowed. Colours are on the scale 0..255, lengths in world units.
 * geometry: centre, radius, 0, 0 of a sphere; point, normal of a plane. lights: colour, position.
 * Deliveries 1 and 2 hold defaults in what their files lack (see ct_default_material). */
typedef struct ct_scene_view {
  int delivery; /* 1 ray casting, 2 Phong, 3 Whitted */
  int64_t v_res, h_res;
  double pixel_size, screen_distance;
  double eye[3], target[3], up[3], background[3];
  int64_t max_depth;
  size_t n_objects, n_lights;
  const uint8_t *kind;    /* n_objects */
  const double *color;    /* n_objects x 3 */
  const double *material; /* n_objects x CT_MATERIAL_COLUMNS */
  const double *geometry; /* n_objects x CT_GEOMETRY_COLUMNS */
  double ambient[3];
  const double *lights; /* n_lights x CT_LIGHT_COLUMNS */
} ct_scene_view;

/* ka kd ks eta kr kt n where the delivery's files state none. */
CT_API void ct_default_material(int delivery, double material[CT_MATERIAL_COLUMNS]);

typedef struct ct_scene ct_scene;

/* Reads a scene file of n_bytes (no terminating zero needed). delivery 0 tells it from the text.
 * On CT_ERR_SCENE *fault says where and why, and *out is NULL. Time is linear in n_bytes, memory
 * at most 10 bytes a byte of text plus a constant. */
CT_API ct_status ct_scene_parse(const char *text, size_t n_bytes, int delivery, ct_scene **out,
                         ct_fault *fault);
CT_API void ct_scene_free(ct_scene *scene);

/* The scene's numbers; valid until ct_scene_free. */
CT_API ct_scene_view ct_scene_data(const ct_scene *scene);

/* Checks a view that was not parsed: the same rules, with fault->where naming the field. */
CT_API ct_status ct_scene_check(const ct_scene_view *view, ct_fault *fault);

/* ---- Options ---- */

typedef struct ct_options ct_options;

/* Bits of an effect mask: what the tracer is to compute. */
enum {
  CT_FLAT = 1 << 0,
  CT_AMBIENT = 1 << 1,
  CT_DIFFUSE = 1 << 2,
  CT_SPECULAR = 1 << 3,
  CT_SHADOWS = 1 << 4,
  CT_REFLECTION = 1 << 5,
  CT_REFRACTION = 1 << 6,
  CT_TOTAL_REFLECTION = 1 << 7,
  CT_ALL_EFFECTS = 0xff
};

CT_API ct_options *ct_options_new(void); /* the defaults of the design; NULL: no memory */
CT_API void ct_options_free(ct_options *options);

/* A reading is a named alternative meaning of the specification, such as "tir", "ignore". Numeric
 * readings ("epsilon") take a decimal. CT_ERR_OPTION fills *fault (expected, found). */
CT_API ct_status ct_options_set(ct_options *options, const char *name, const char *value,
                         ct_fault *fault);
/* Scalar type of the tracer, "f64" by default; one that does not exist on this platform is refused
 * with a list of those that do. */
CT_API ct_status ct_options_set_precision(ct_options *options, const char *name, ct_fault *fault);
/* nearest (the default), up, down or zero: the processor's rounding mode while rays are traced, to
 * see how many digits rounding costs. f32, f64 and f80 only: ct_render refuses it elsewhere. */
CT_API ct_status ct_options_set_rounding(ct_options *options, const char *mode, ct_fault *fault);
/* The most that may be used of the processor's instruction sets: generic, fma, avx2, avx512, each
 * of which holds those before it, or native (the default), all that there is. A cap above what the
 * processor has is no error. Every set gives the same bits; fewer are slower. */
CT_API ct_status ct_options_set_instructions(ct_options *options, const char *most,
                                             ct_fault *fault);
/* How the objects that a ray meets are found: scan asks every one, tree (a tree of boxes over the
 * spheres) those near the ray; auto (the default) takes the tree where there are enough spheres for
 * it to pay. All give the same bits. */
CT_API ct_status ct_options_set_search(ct_options *options, const char *way, ct_fault *fault);
/* Leaves out secondary rays that can hardly matter: every channel of a pixel is at most `tolerance`
 * less than without, never more. 0 (the default) leaves out none. A tree's hash and the counts of
 * rays are of what is traced; ct_certify takes no notice. */
CT_API ct_status ct_options_set_tolerance(ct_options *options, double tolerance, ct_fault *fault);
CT_API void ct_options_set_effects(ct_options *options, unsigned mask);
CT_API void ct_options_set_threads(ct_options *options, unsigned n_threads); /* 0: all allowed cores */
CT_API void ct_options_set_ray_budget(ct_options *options, uint64_t n_rays);
/* Renders rows [begin, end) only; outputs then start at row begin. end 0: to the last row. */
CT_API void ct_options_set_rows(ct_options *options, int64_t begin, int64_t end);
/* Where in its pixel a primary ray passes: 0 (the default) through the centre, as the specification
 * has it; otherwise a point that is uniform over the pixel and depends on this seed, the row and the
 * column alone. CT_ERR_OPTION from ct_certify, whose truth is that of the centre. */
CT_API void ct_options_set_jitter(ct_options *options, uint64_t seed);

/* The table of readings, index from 0; NULL past the end. `values` are separated by '|'. */
CT_API const char *ct_reading_name(size_t index);
CT_API const char *ct_reading_default(size_t index);
CT_API const char *ct_reading_values(size_t index);

/* The precisions that exist on this platform, narrowest first; NULL past the end. Out of
 *   f32   float
 *   f64   double
 *   f64c  double, with compensated intersection, refraction and highlight
 *   f80   the x87's long double
 *   dd    double-double, 106 bits
 *   f128  __float128, 113 bits */
CT_API const char *ct_precision_name(size_t index);

/* The instruction sets that this processor has, "generic" first; NULL past the end. */
CT_API const char *ct_instructions_name(size_t index);

/* ---- Rendering ---- */

enum { CT_CONTRIBUTIONS = 6 }; /* base, diffuse, specular, reflection, refraction, total refl. */

/* Where results go, row 0 at the top, channels red green blue; every pointer may be NULL.
 * `contributions` splits a pixel's value at its first hit; base is the flat colour, the ambient
 * term or the background. Its six terms add up to the image, but for rounding. */
typedef struct ct_outputs {
  double *image;         /* rows x h_res x 3, linear, unclamped */
  int32_t *object;       /* rows x h_res: index of the first object hit, -1: none */
  double *t_world;       /* rows x h_res: distance to that hit, infinity: none */
  double *normal;        /* rows x h_res x 3: unit normal as in the file, 0 0 0: none */
  uint64_t *tree;        /* rows x h_res: hash of the ray tree's decisions, not of its numbers */
  uint32_t *rays;        /* rows x h_res: rays of every kind traced for the pixel */
  double *contributions; /* rows x h_res x CT_CONTRIBUTIONS x 3 */
  double *image_low;     /* rows x h_res x 3: what rounding the image to double left out */
} ct_outputs;

typedef struct ct_stats {
  uint64_t n_primary, n_shadow, n_reflected, n_refracted;
  unsigned n_threads;
} ct_stats;

/* Called in the calling thread about every 50 ms with the part of the work that is done, in units
 * of no meaning; a value other than 0 stops. */
typedef int (*ct_progress)(void *user, uint64_t done, uint64_t total);

typedef struct ct_tree ct_tree;

/* The tree of a scene, to render it in several calls (bands of rows, other readings) and build but
 * once. It is used for views with the same eye and the same arrays; other calls build their own.
 * *out is NULL on failure. The options borrow it; NULL takes it away again. */
CT_API ct_status ct_tree_new(const ct_scene_view *view, ct_progress progress, void *user,
                             ct_tree **out);
CT_API void ct_tree_free(ct_tree *tree);
CT_API void ct_options_set_tree(ct_options *options, const ct_tree *tree);

CT_API ct_status ct_render(const ct_scene_view *view, const ct_options *options,
                    const ct_outputs *outputs, ct_progress progress, void *user, ct_stats *stats);

enum { CT_LARGEST_CELL = 64 };

/* Renders some cells of a frame that is cut into squares of side x side pixels, such as the samples
 * of some pixels of a coarser frame. `cells` are indices row * (h_res / side) + column of squares;
 * v_res and h_res have to be multiples of side, 1 to CT_LARGEST_CELL. Outputs are n_cells x side x
 * side, in that order, with the bits of ct_render; the options' rows are not heeded. */
CT_API ct_status ct_render_cells(const ct_scene_view *view, const ct_options *options,
                                 const int64_t *cells, uint64_t n_cells, int64_t side,
                                 const ct_outputs *outputs, ct_progress progress, void *user,
                                 ct_stats *stats);

/* ---- Measuring ---- */

/* Rays in columns: x, y and z of n origins and of n directions of length 1. */
typedef struct ct_rays {
  size_t n;
  const double *origin[3], *direction[3];
} ct_rays;

/* The nearest hit of each ray and nothing else, by the code that ct_render meets objects with, in
 * the calling thread: the distance (infinity: none) and the object (-1). Blocks of some rays
 * are traced `passes` times each: with more than one, memory counts for less. Two options are
 * heeded besides those of ct_render's hits: instructions, and CT_ERR_OPTION for a precision other
 * than f64. *seconds, unless it is NULL, becomes the processor time that the rays took, without
 * what is done once for a scene. */
CT_API ct_status ct_intersect(const ct_scene_view *view, const ct_options *options,
                              const ct_rays *rays, size_t passes, double *t_world, int64_t *object,
                              double *seconds);

/* The most products and sums of doubles a second that the vectors of the options' instruction set
 * have done here, each a rounding of its own (no fused ones), in thousandths of `seconds` of
 * processor time; 0 where there are no vectors. */
CT_API double ct_peak_flops(const ct_options *options, double seconds);

/* ---- Certification ---- */

typedef enum ct_certify_class {
  CT_CERTIFIED,             /* enclosed to the tolerance */
  CT_UNDECIDABLE_EDGE,      /* a decision open in the widest type: see the alternatives */
  CT_UNDECIDABLE_PRECISION, /* a quantity too wide even in the widest type */
  CT_UNDECIDABLE_BUDGET     /* too many outcomes, decisions or rays */
} ct_certify_class;

/* Which decision was open first. */
typedef enum ct_certify_decision {
  CT_DECISION_NONE,
  CT_DECISION_NEAREST,  /* which object is hit, if any */
  CT_DECISION_SHADOW,   /* whether a light is blocked */
  CT_DECISION_SIDE,     /* from which side a surface is met */
  CT_DECISION_TOTAL,    /* whether light is totally reflected */
  CT_DECISION_GATE,     /* whether n.l > 0, where a reading asks */
  CT_DECISION_PRECISION /* none: a quantity was too wide */
} ct_certify_decision;

typedef struct ct_certify_request {
  const int64_t *pixels; /* indices row * h_res + column; NULL: all */
  uint64_t n_pixels;     /* of that list */
  double tolerance;      /* greatest width of a certified enclosure, such as 1e-9 */
  /* 0: truth. Otherwise the relative error of the arithmetic under test: the enclosures then hold
   * whatever a renderer with that error in directions, hits and sums may return. */
  double kappa;
} ct_certify_request;

enum { CT_ALTERNATIVES = 16 };

/* Where enclosures go, one entry a pixel asked for; every pointer may be NULL. A pixel without an
 * enclosure (PRECISION, BUDGET) has -infinity and infinity. */
typedef struct ct_enclosures {
  double *lo, *hi;         /* x 3 */
  uint8_t *pixel_class;    /* ct_certify_class */
  uint8_t *level;          /* type that it ended in: 0 double, 1 double-double, 2 float128 */
  uint8_t *decision;       /* ct_certify_decision of the first open decision */
  int32_t *depth, *object; /* where that was; object -1: none in particular */
  uint8_t *n_alternatives;
  double *alternatives; /* x CT_ALTERNATIVES x 2 x 3: lo and hi of each possible value */
} ct_enclosures;

typedef struct ct_certify_stats {
  uint64_t n_closed[3]; /* pixels certified in double, double-double, float128 */
} ct_certify_stats;

/* CT_ERR_OPTION for offset=bound, which has no meaning in real arithmetic. The same bits for every set
 * of instructions; a build by a compiler without vector types has other enclosures of the same
 * values. */
CT_API ct_status ct_certify(const ct_scene_view *view, const ct_options *options,
                            const ct_certify_request *request, const ct_enclosures *out,
                            ct_progress progress, void *user, ct_certify_stats *stats);

/* ---- Explanation ---- */

typedef enum ct_ray_kind {
  CT_RAY_PRIMARY,
  CT_RAY_SHADOW,
  CT_RAY_REFLECTED,
  CT_RAY_REFRACTED,
  CT_RAY_TOTALLY_REFLECTED
} ct_ray_kind;

/* One ray of a pixel's tree. A colour's terms add up: color = base + diffuse + specular + unsent +
 * the sum over its secondary rays of (their weight / weight) * their color, but for rounding and
 * for recursion=clamp and scale. So the pixel is the sum over its rays other than shadow rays of
 * weight * (base + diffuse + specular + unsent).
 *
 * `margin` is the relative change of a quantity that would change the nearest decision of this ray
 * or of its hit: the smallest over the objects i of
 *   CT_DECISION_NEAREST  (t_i - t) / t of an object behind the hit (0: a tie; a surface that is
 *                        textually the hit one is no alternative); |r^2 - l^2| / r^2, l the distance
 *                        of the ray's line from the centre, of a sphere that is hit from outside or
 *                        missed before the hit; |d.n| of a plane that is hit, or of any plane where
 *                        nothing is; the distance of the ray's start from a surface that is hit or
 *                        lies behind it, relative to the magnitudes that it is the difference of;
 *                        |t - far| / far
 *   CT_DECISION_SIDE     |n.wo| at the hit, where kt > 0 or a reading asks for the side
 *   CT_DECISION_TOTAL    |Delta| of the specification's 4.2, where kt > 0 or tir=always
 *   CT_DECISION_GATE     |n.l|, where specular_gate=lit
 * and for a shadow ray of
 *   CT_DECISION_SHADOW   if nothing blocks: the same distances of what nearly does, up to the light,
 *                        and (t_i - limit) / limit of what stands beyond it. If blocked: the
 *                        largest over all blockers of how nearly each does not, as all would have
 *                        to go.
 * Left out is the surface that the ray leaves: the offset decides about it, and `clearance` is the
 * distance of the ray's start from it, relative as above. Both are infinity where there is none.
 * Measured on 18 scenes: wherever float32 decides otherwise than double, one of the two is below
 * 6e-6 for some ray of the pixel. */
typedef struct ct_ray_record {
  int32_t kind;            /* ct_ray_kind */
  int32_t margin_decision; /* ct_certify_decision */
  int32_t inside, total;   /* of the hit: met from inside (n.wo <= 0); totally reflected */
  int64_t parent;          /* index of the ray whose hit it leaves; -1: none */
  int64_t depth;           /* bounces before it; of a shadow ray those of its parent */
  int64_t object;          /* hit, or the first in the file that blocks a shadow ray; -1: none */
  int64_t light;           /* of a shadow ray; -1 otherwise */
  int64_t margin_object;   /* that the decision is about; -1: none */
  /* Product of kr and kt (as they act) down to the ray; a shadow ray has its parent's. */
  double weight;
  double origin[3], direction[3]; /* world units; of length 1 */
  double t_world;                 /* to the hit or the blocker; infinity: none */
  double point[3], normal[3];     /* of the hit or the blocker, as in the file, unit; 0 0 0: none */
  double light_distance;          /* of a shadow ray, from the hit to the light; 0 otherwise */
  double color[3];                /* what the ray returns; a blocked shadow ray 0 0 0 */
  /* Local terms of the hit, or what returns where nothing is hit (base). Of a shadow ray: what its
   * light adds to its parent's terms if nothing blocks it. */
  double base[3], diffuse[3], specular[3];
  double unsent[3]; /* what exhausted=background adds for rays not sent for want of depth */
  double margin, clearance;
} ct_ray_record;

typedef struct ct_pixel_tree {
  uint64_t n_rays; /* all of them, also those beyond the capacity */
  uint64_t tree;   /* as in ct_outputs: the same bits as ct_render's */
  double color[3]; /* the same */
} ct_pixel_tree;

/* Records the rays of pixel (row, column) in double, depth first in the order in which they are
 * traced: those of a hit's lights in file order, then the reflected and the refracted one with all
 * that follows. The first `capacity` of them are written. CT_ERR_OPTION for a precision other than
 * f64 or a rounding mode other than nearest. */
CT_API ct_status ct_explain(const ct_scene_view *view, const ct_options *options, int64_t row,
                            int64_t column, ct_ray_record *records, size_t capacity,
                            ct_pixel_tree *tree, ct_progress progress, void *user);

CT_API uint64_t ct_max_tree_depth(void);

/* ---- Conditioning ---- */

typedef struct ct_perturb_request {
  const int64_t *pixels; /* indices row * h_res + column; NULL: all */
  uint64_t n_pixels;     /* of that list */
  uint64_t n_samples;    /* renders of each pixel */
  /* Relative error of the arithmetic under test, as ct_certify_request.kappa: every component of
   * a direction, and of a hit relative to |origin| + |point|, is moved by up to that much,
   * uniformly. 0: every sample is ct_render's pixel, bit for bit. */
  double error;
  uint64_t seed;
} ct_perturb_request;

/* Where samples go, n_samples a pixel asked for; every pointer may be NULL. */
typedef struct ct_samples {
  double *colors;  /* x n_samples x 3 */
  uint64_t *trees; /* x n_samples: hash of the ray tree's decisions */
} ct_samples;

/* Renders pixels again and again in double with small random errors, to see what rounding may do to
 * them. A sample depends on the seed, its pixel and its number alone. CT_ERR_OPTION for a precision
 * other than f64 or a rounding mode other than nearest. */
CT_API ct_status ct_perturb(const ct_scene_view *view, const ct_options *options,
                            const ct_perturb_request *request, const ct_samples *out,
                            ct_progress progress, void *user);

#ifdef __cplusplus
}
#endif
#endif
