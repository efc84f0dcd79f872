/* Work in chunks over threads, with progress and cancellation in the calling thread. Internal. */
#ifndef CT_PARALLEL_H
#define CT_PARALLEL_H

#include <stdatomic.h>

#include "crosstrace.h"

/* Does items [begin, end) with the thread's own state; returns at once where *stop is set. */
typedef void (*ct_chunk)(void *job, void *thread_state, uint64_t begin, uint64_t end);

typedef struct ct_work {
  ct_chunk run;
  void *job;
  uint64_t n_items, chunk; /* a call of run does `chunk` items, the last one what is left */
  uint64_t claim;          /* chunks that a thread takes in a row, at most; 0: one */
  size_t stack_bytes;
  /* One state a thread, made and given back in that thread; both may be NULL. */
  void *(*enter)(void *job);
  void (*leave)(void *job, void *thread_state);
  atomic_int *stop; /* a ct_status; set by anybody to end the work */
} ct_work;

/* Runs the work on n_threads (0: all cores that this process may use). Returns *stop, or
 * CT_ERR_THREAD. `progress` is called about every 50 ms. */
ct_status ct_parallel(const ct_work *work, unsigned n_threads, ct_progress progress, void *user,
                      unsigned *n_used);

#endif
