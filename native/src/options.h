/* Options as the tracer reads them. Internal. */
#ifndef CT_OPTIONS_H
#define CT_OPTIONS_H

#include "crosstrace.h"
#include "instructions.h"

/* Choices, in the order of the table in options.c; the values of each, 0 the default. */
typedef enum ct_choice {
  CT_MIX,
  CT_PLANE_NORMAL,
  CT_LIGHTING_NORMAL,
  CT_VIEW,
  CT_SPECULAR_GATE,
  CT_GLASS_SHADOW,
  CT_SHADOW_DISTANCE,
  CT_OFFSET,
  CT_EPSILON_TWICE,
  CT_EPSILON_FOR,
  CT_DEPTH,
  CT_EXHAUSTED,
  CT_MISS,
  CT_SIDE,
  CT_NESTING,
  CT_TIR,
  CT_INNER_REFLECTION,
  CT_RECURSION,
  CT_INDEX,
  CT_N_CHOICES
} ct_choice;

enum { CT_MIX_SUM, CT_MIX_CONVEX };
enum { CT_PLANE_NORMAL_UNIT, CT_PLANE_NORMAL_RAW };
enum { CT_LIGHTING_NORMAL_GIVEN, CT_LIGHTING_NORMAL_FACING };
enum { CT_VIEW_RAY, CT_VIEW_EYE };
enum { CT_SPECULAR_GATE_NONE, CT_SPECULAR_GATE_LIT };
enum { CT_GLASS_SHADOW_OPAQUE, CT_GLASS_SHADOW_CLEAR };
enum { CT_SHADOW_DISTANCE_LIGHT, CT_SHADOW_DISTANCE_IGNORED };
enum { CT_OFFSET_DIRECTION, CT_OFFSET_NORMAL, CT_OFFSET_BOUND, CT_OFFSET_MITSUBA };
enum { CT_EPSILON_FOR_ALL, CT_EPSILON_FOR_SHADOW };
enum { CT_DEPTH_AS_GIVEN, CT_DEPTH_MINUS_ONE, CT_DEPTH_PLUS_ONE };
enum { CT_EXHAUSTED_BLACK, CT_EXHAUSTED_BACKGROUND };
enum { CT_MISS_BACKGROUND, CT_MISS_BLACK };
enum { CT_SIDE_RELATIVE, CT_SIDE_INVERTED, CT_SIDE_ONE_WAY };
enum { CT_NESTING_RELATIVE, CT_NESTING_TRACKED, CT_NESTING_INTERIORS };
enum { CT_TIR_REPLACE, CT_TIR_IGNORE, CT_TIR_ADD, CT_TIR_PLUS_ONE, CT_TIR_NEEDS_KR, CT_TIR_ALWAYS };
enum { CT_INNER_REFLECTION_ON, CT_INNER_REFLECTION_OFF };
enum { CT_RECURSION_FREE, CT_RECURSION_CLAMP, CT_RECURSION_SCALE };
enum { CT_INDEX_EXACT, CT_INDEX_FLOAT32 };

/* How the objects on a ray are found. */
enum { CT_SEARCH_AUTO, CT_SEARCH_SCAN, CT_SEARCH_TREE };
enum { CT_ROUND_NEAREST, CT_ROUND_UP, CT_ROUND_DOWN, CT_ROUND_ZERO };

struct ct_options {
  int choice[CT_N_CHOICES];
  double epsilon;    /* world units */
  double shadow_min; /* shadow hits at or nearer than this do not block */
  double light_min;  /* shadow hits as near as this to the light do not block */
  double far;        /* hits beyond this do not exist; 0: no limit */
  double tolerance;  /* how much darker pruning may make a pixel; 0: nothing is pruned */
  size_t precision; /* index of ct_precision_kernel */
  int rounding;     /* CT_ROUND_... */
  ct_instructions instructions; /* the most that may be used */
  int search;       /* CT_SEARCH_... */
  const ct_tree *tree; /* borrowed; NULL: every call builds its own */
  unsigned effects, n_threads;
  uint64_t ray_budget;
  uint64_t jitter; /* seed; 0: through the centre of each pixel */
  int64_t row_begin, row_end;
};

/* max_depth under the depth reading; 0 where no secondary ray is called for. */
int64_t ct_effective_depth(const ct_scene_view *view, const ct_options *options);

#endif
