/* What must hold of the parser on any bytes: it ends, it keeps to its memory, a refusal says where
 * and why, and an accepted scene is one that the check of plain data accepts too. */
#include <stdlib.h>
#include <string.h>

#include "crosstrace.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  for (int delivery = 0; delivery <= 3; delivery++) {
    ct_scene *scene = NULL;
    ct_fault fault;
    ct_status status = ct_scene_parse((const char *)bytes, n_bytes, delivery, &scene, &fault);
    if (status == CT_ERR_SCENE) {
      if (scene || !fault.line || !fault.column || !*fault.expected || !*fault.found) abort();
      continue;
    }
    if (status != CT_OK || !scene) abort();
    ct_scene_view view = ct_scene_data(scene);
    if (delivery && view.delivery != delivery) abort();
    if (ct_scene_check(&view, &fault) != CT_OK) abort();
    ct_scene_free(scene);
  }
  return 0;
}
