/* Names of the error codes, and the version. */
#include "crosstrace.h"

const char *ct_status_text(ct_status status) {
  switch (status) {
    case CT_OK: return "no error";
    case CT_ERR_MEMORY: return "out of memory";
    case CT_ERR_SCENE: return "the scene is malformed or meaningless";
    case CT_ERR_OPTION: return "unknown option or value";
    case CT_ERR_ARGUMENT: return "an argument is null or out of range";
    case CT_ERR_CANCELLED: return "cancelled";
    case CT_ERR_BUDGET: return "the ray budget is used up: the ray trees grow too fast with max_depth";
    case CT_ERR_DEPTH: return "a ray tree is deeper than the native tracer follows (100000 bounces)";
    case CT_ERR_THREAD: return "no thread could be started";
  }
  return "unknown error";
}

const char *ct_version(void) { return CT_VERSION; }
