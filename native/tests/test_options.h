/* Options for the C tests. CT_TEST_INSTRUCTIONS caps the processor's instruction sets, so that every
 * test can run with each of them switched off; the library itself reads no environment. */
#ifndef CT_TESTS_TEST_OPTIONS_H
#define CT_TESTS_TEST_OPTIONS_H

#include <stdlib.h>

#include "check.h"
#include "crosstrace.h"

static inline ct_options *test_options(void) {
  ct_fault fault;
  const char *cap = getenv("CT_TEST_INSTRUCTIONS");
  ct_options *options = ct_options_new();
  CHECK(options);
  if (cap) CHECK(ct_options_set_instructions(options, cap, &fault) == CT_OK);
  return options;
}

#endif
