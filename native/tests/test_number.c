/* Decimals are read to the nearest double, whatever the locale, and nothing else is a number. */
#define _GNU_SOURCE
#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "check.h"
#include "text.h"

static locale_t c_locale;

static int read_text(const char *text, double *value) {
  return ct_read_number(text, strlen(text), c_locale, value);
}

static void numbers_are_the_nearest_doubles(void) {
  static const struct {
    const char *text;
    double value;
  } cases[] = {{"5", 5},
               {"+5", 5},
               {"-5.", -5},
               {".5", 0.5},
               {"1e-3", 1e-3},
               {"1E+3", 1000},
               {"480.0", 480},
               {"0.1", 0x1.999999999999ap-4},
               {"9007199254740993", 0x1p53}, /* a tie goes to even */
               {"9007199254740993.00000000000000000001", 0x1.0000000000001p53},
               {"123456789012345678901234567890", 0x1.8ee90ff6c373ep96},
               {"2.2250738585072011e-308", 0x0.fffffffffffffp-1022}, /* the famous hang */
               {"4.9e-324", 0x1p-1074},
               {"1e-400", 0},
               {"1.7976931348623157e308", 0x1.fffffffffffffp1023},
               {"0e999999999999", 0},
               {"0.000000000000000000000000000001e30", 1}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    double value = -1;
    CHECK(read_text(cases[i].text, &value) == CT_NUMBER_OK);
    CHECK(value == cases[i].value);
  }
  double zero = 1;
  CHECK(read_text("-0", &zero) == CT_NUMBER_OK && zero == 0 && signbit(zero));
}

static void anything_else_is_refused(void) {
  static const char *const cases[] = {"",    "+",   ".",    "e5",    "1e",   "1e+", "0x10", "nan",
                                      "inf", "1,5", "1_000", "1.2.3", "--1",  "1f",  "\xd9\xa1",
                                      "1e5.", "infinity", "+-1"};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    double value;
    CHECK(read_text(cases[i], &value) == CT_NUMBER_MALFORMED);
  }
  double value;
  CHECK(read_text("1e309", &value) == CT_NUMBER_OVERFLOW);
  CHECK(read_text("-1e99999999999999999999", &value) == CT_NUMBER_OVERFLOW);
}

/* 17 digits name every double, so printing and reading must come back to the same bits. */
static void seventeen_digits_come_back(void) {
  uint64_t state = 1;
  for (int i = 0; i < 200000; i++) {
    double value, back;
    char text[40];
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    memcpy(&value, &state, sizeof value);
    if (!isfinite(value)) continue;
    snprintf(text, sizeof text, "%.17g", value);
    CHECK(read_text(text, &back) == CT_NUMBER_OK);
    CHECK(memcmp(&value, &back, sizeof value) == 0);
  }
}

static void a_long_number_is_read_whole(void) {
  static char text[100003];
  memset(text, '0', 100000);
  memcpy(text + 100000, "12", 3);
  double value;
  CHECK(read_text(text, &value) == CT_NUMBER_OK && value == 12);
  memset(text, '9', 100002);
  CHECK(read_text(text, &value) == CT_NUMBER_OVERFLOW);
  text[1] = '.';
  CHECK(read_text(text, &value) == CT_NUMBER_OK && value == 10);
}

int main(void) {
  c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
  CHECK(c_locale != (locale_t)0);
  numbers_are_the_nearest_doubles();
  anything_else_is_refused();
  seventeen_digits_come_back();
  a_long_number_is_read_whole();
  freelocale(c_locale);
  return 0;
}
