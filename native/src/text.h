/* The text side of the library: numbers, and what is wrong with a text. Internal. */
#ifndef CT_TEXT_H
#define CT_TEXT_H

#include "crosstrace.h"

enum { CT_NUMBER_OK, CT_NUMBER_MALFORMED, CT_NUMBER_OVERFLOW, CT_NUMBER_NO_MEMORY };

/* Reads a whole token; c_locale is a locale_t of the "C" locale. */
int ct_read_number(const char *token, size_t n_bytes, void *c_locale, double *value);

/* What a field of a scene may hold; the rules are one table for text and for plain data. */
typedef enum ct_rule {
  CT_RULE_FINITE,      /* any number up to CT_LARGEST in magnitude */
  CT_RULE_POSITIVE,    /* > 0 */
  CT_RULE_COLOR,       /* 0..255 */
  CT_RULE_COEFFICIENT, /* 0..1 */
  CT_RULE_RESOLUTION,  /* integer 1..CT_LARGEST_SIDE */
  CT_RULE_COUNT        /* integer 0..2^31 - 1 */
} ct_rule;

#define CT_LARGEST 1e100 /* squares and products of two lengths then stay finite in double */
#define CT_LARGEST_SIDE 1048576

/* NULL where the value keeps the rule, else what was expected, as a phrase. */
const char *ct_rule_breach(ct_rule rule, double value);

/* Checks across fields. Each returns NULL or what was expected. */
const char *ct_target_breach(const double eye[3], const double target[3]);
const char *ct_up_breach(const double eye[3], const double target[3], const double up[3]);
const char *ct_index_breach(double kt, double n);

void ct_fault_set(ct_fault *fault, const char *where, const char *expected, const char *found);
/* "a number greater than 0 (the radius)", or one of the two where the other is empty. */
void ct_fault_phrase(char *out, size_t size, const char *expected, const char *what);
void ct_fault_number(ct_fault *fault, const char *where, const char *expected, double found);

#endif
