/* Splits a scene file into tokens and knows where each stands. Internal. */
#ifndef CT_LEXER_H
#define CT_LEXER_H

#include "text.h"

typedef struct ct_lexer {
  const char *next, *end;   /* text not yet read */
  const char *token;        /* the current token; empty at the end of the file */
  size_t token_bytes;
  size_t line;              /* of the current token, from 1 */
  const char *line_start;   /* first byte of that line */
  void *c_locale;           /* of the "C" locale, owned */
} ct_lexer;

/* CT_ERR_MEMORY where the system gives no locale object. */
ct_status ct_lexer_open(ct_lexer *lexer, const char *text, size_t n_bytes);
void ct_lexer_close(ct_lexer *lexer);

/* Moves to the next token: a run of bytes other than white space, or one of the signs * and /. */
void ct_lexer_advance(ct_lexer *lexer);
int ct_lexer_at_end(const ct_lexer *lexer);
int ct_lexer_at_sign(const ct_lexer *lexer);

/* Fills *fault with the current token as what was found. Returns CT_ERR_SCENE. */
ct_status ct_lexer_refuse(const ct_lexer *lexer, ct_fault *fault, const char *where,
                          const char *expected);

#endif
