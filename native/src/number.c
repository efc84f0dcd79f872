/* Reads one ASCII decimal, correctly rounded, whatever the locale.
 *
 * Grammar: [+-] (digits [. digits*] | . digits) [(e|E) [+-] digits]. Nothing else is a number: no
 * hexadecimal, no infinity, no thousands separator.
 *
 * Method: up to 19 significant digits and a power of ten up to 22 are exact in double, so one
 * multiplication or division rounds correctly (Clinger 1990, section 3). Everything else goes to
 * the C library's strtod in the "C" locale, which glibc and the BSDs round correctly.
 */
#define _GNU_SOURCE
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined(__APPLE__)
#include <xlocale.h>
#endif

#include "text.h"

static const double powers_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                       1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                       1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static int is_digit(char c) { return c >= '0' && c <= '9'; }

/* The slow path: a copy ended by zero, as strtod needs one. The token matches the grammar. */
static int read_slowly(const char *token, size_t n_bytes, void *c_locale, double *value) {
  char small[128];
  char *copy = n_bytes < sizeof small ? small : malloc(n_bytes + 1);
  if (!copy) return CT_NUMBER_NO_MEMORY;
  memcpy(copy, token, n_bytes);
  copy[n_bytes] = 0;
  *value = strtod_l(copy, NULL, (locale_t)c_locale);
  if (copy != small) free(copy);
  return isfinite(*value) ? CT_NUMBER_OK : CT_NUMBER_OVERFLOW;
}

int ct_read_number(const char *token, size_t n_bytes, void *c_locale, double *value) {
  const char *p = token, *end = token + n_bytes;
  int negative = 0, n_significant = 0, scale = 0, exact = 1;
  uint64_t mantissa = 0;
  size_t n_digits = 0;
  if (p < end && (*p == '+' || *p == '-')) negative = *p++ == '-';
  for (int after_point = 0; p < end; p++) {
    if (*p == '.') {
      if (after_point) return CT_NUMBER_MALFORMED;
      after_point = 1;
      continue;
    }
    if (!is_digit(*p)) break;
    n_digits++;
    if (n_significant || *p != '0') {
      if (++n_significant <= 19)
        mantissa = mantissa * 10 + (uint64_t)(*p - '0');
      else
        exact = 0;
    }
    if (after_point && exact) scale--;
    if (scale < -1000) exact = 0;
    if (n_significant > 19) n_significant = 20;
  }
  if (!n_digits) return CT_NUMBER_MALFORMED;
  if (p < end && (*p == 'e' || *p == 'E')) {
    int exponent = 0, minus = 0;
    p++;
    if (p < end && (*p == '+' || *p == '-')) minus = *p++ == '-';
    if (p == end) return CT_NUMBER_MALFORMED;
    for (; p < end && is_digit(*p); p++)
      if (exponent < 100000) exponent = exponent * 10 + (*p - '0');
    scale += minus ? -exponent : exponent;
  }
  if (p != end) return CT_NUMBER_MALFORMED;
  if (mantissa == 0 && exact) {
    *value = negative ? -0.0 : 0.0;
    return CT_NUMBER_OK;
  }
  if (exact && mantissa <= (UINT64_C(1) << 53) && scale >= -22 && scale <= 22) {
    double magnitude = (double)mantissa;
    magnitude = scale < 0 ? magnitude / powers_of_ten[-scale] : magnitude * powers_of_ten[scale];
    *value = negative ? -magnitude : magnitude;
    return CT_NUMBER_OK;
  }
  return read_slowly(token, n_bytes, c_locale, value);
}
