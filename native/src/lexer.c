/* Tokens of a scene file: white space apart, * and / on their own, a byte-order mark skipped.
 *
 * Lines end in LF, CR LF or CR. Columns count characters of UTF-8 from 1, as editors show them.
 */
#define _GNU_SOURCE
#include "lexer.h"

#include <locale.h>
#include <stdio.h>
#include <string.h>
#if defined(__APPLE__)
#include <xlocale.h>
#endif

static int is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

static int is_sign(char c) { return c == '*' || c == '/'; }

ct_status ct_lexer_open(ct_lexer *lexer, const char *text, size_t n_bytes) {
  lexer->c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
  if (!lexer->c_locale) return CT_ERR_MEMORY;
  if (n_bytes >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) {
    text += 3;
    n_bytes -= 3;
  }
  lexer->next = lexer->token = lexer->line_start = text;
  lexer->end = text + n_bytes;
  lexer->token_bytes = 0;
  lexer->line = 1;
  ct_lexer_advance(lexer);
  return CT_OK;
}

void ct_lexer_close(ct_lexer *lexer) { freelocale((locale_t)lexer->c_locale); }

void ct_lexer_advance(ct_lexer *lexer) {
  const char *p = lexer->next, *end = lexer->end;
  while (p < end && is_space(*p)) {
    int ends_line = *p == '\n' || (*p == '\r' && !(p + 1 < end && p[1] == '\n'));
    p++;
    if (ends_line) {
      lexer->line++;
      lexer->line_start = p;
    }
  }
  lexer->token = p;
  if (p < end && is_sign(*p))
    p++;
  else
    while (p < end && !is_space(*p) && !is_sign(*p)) p++;
  lexer->token_bytes = (size_t)(p - lexer->token);
  lexer->next = p;
}

int ct_lexer_at_end(const ct_lexer *lexer) { return lexer->token_bytes == 0; }

int ct_lexer_at_sign(const ct_lexer *lexer) {
  return lexer->token_bytes == 1 && is_sign(*lexer->token);
}

/* The token in quotes, cut at 32 bytes, anything but printable ASCII as \xNN. */
static void quote(const ct_lexer *lexer, char *out, size_t size) {
  if (ct_lexer_at_end(lexer)) {
    snprintf(out, size, "end of file");
    return;
  }
  size_t shown = lexer->token_bytes < 32 ? lexer->token_bytes : 32, n = 0;
  out[n++] = '\'';
  for (size_t i = 0; i < shown && n + 10 < size; i++) {
    unsigned char c = (unsigned char)lexer->token[i];
    if (c >= 0x20 && c < 0x7f && c != '\\')
      out[n++] = (char)c;
    else
      n += (size_t)snprintf(out + n, size - n, "\\x%02x", c);
  }
  snprintf(out + n, size - n, "%s", shown < lexer->token_bytes ? "...'" : "'");
}

ct_status ct_lexer_refuse(const ct_lexer *lexer, ct_fault *fault, const char *where,
                          const char *expected) {
  char found[sizeof fault->found];
  if (!fault) return CT_ERR_SCENE;
  quote(lexer, found, sizeof found);
  ct_fault_set(fault, where, expected, found);
  fault->line = lexer->line;
  fault->column = 1;
  for (const char *p = lexer->line_start; p < lexer->token; p++)
    fault->column += ((unsigned char)*p & 0xc0) != 0x80; /* count starts of characters */
  return CT_ERR_SCENE;
}
