/* Nothing of its own: the static library as a shared one, to list the names that it exports. */
#include "crosstrace.h"

const char *ct_shared_version(void);
const char *ct_shared_version(void) { return ct_version(); }
