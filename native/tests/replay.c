/* Runs files through the fuzzer's function, for compilers without a fuzzer. */
#include <stdint.h>

#include "check.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes);

int main(int n_arguments, char **arguments) {
  CHECK(n_arguments > 1);
  for (int i = 1; i < n_arguments; i++) {
    FILE *file = fopen(arguments[i], "rb");
    CHECK(file != NULL);
    CHECK(fseek(file, 0, SEEK_END) == 0);
    long n_bytes = ftell(file);
    CHECK(n_bytes >= 0);
    rewind(file);
    /* Exactly as large as the text, so that a read past it is seen by the sanitizer. */
    uint8_t *bytes = malloc(n_bytes ? (size_t)n_bytes : 1);
    CHECK(bytes != NULL);
    CHECK(fread(bytes, 1, (size_t)n_bytes, file) == (size_t)n_bytes);
    fclose(file);
    LLVMFuzzerTestOneInput(bytes, (size_t)n_bytes);
    free(bytes);
  }
  printf("%d inputs replayed\n", n_arguments - 1);
  return 0;
}
