/* Threads do every item once, whatever the sizes; a stop ends them between two chunks. */
#include <string.h>

#include "check.h"
#include "parallel.h"

enum { MOST = 5000 };

typedef struct tally {
  atomic_uint done[MOST];
  atomic_uint n_calls, n_threads, n_left;
  uint64_t chunk, n_items, stop_after;
  atomic_int stop;
} tally;
static tally t;

static void *enter(void *job) {
  atomic_fetch_add(&((tally *)job)->n_threads, 1);
  return job;
}

static void leave(void *job, void *state) {
  CHECK(state == job);
  atomic_fetch_add(&((tally *)job)->n_left, 1);
}

static void count(void *job, void *state, uint64_t begin, uint64_t end) {
  tally *of = job;
  CHECK(state == job && begin < end && end <= of->n_items);
  CHECK(end - begin == of->chunk || end == of->n_items);
  CHECK(begin % of->chunk == 0);
  for (uint64_t i = begin; i < end; i++) atomic_fetch_add(&of->done[i], 1);
  if (atomic_fetch_add(&of->n_calls, 1) + 1 == of->stop_after) atomic_store(&of->stop, CT_ERR_BUDGET);
}

static uint64_t told_done, told_total;

static int hear(void *user, uint64_t done, uint64_t total) {
  (void)user;
  CHECK(done >= told_done && done <= total);
  told_done = done;
  told_total = total;
  return 0;
}

static ct_status run(uint64_t n_items, uint64_t chunk, uint64_t claim, unsigned n_threads,
                     uint64_t stop_after) {
  memset(&t, 0, sizeof t);
  told_done = told_total = 0;
  t.chunk = chunk, t.n_items = n_items, t.stop_after = stop_after;
  ct_work work = {.run = count, .job = &t, .n_items = n_items, .chunk = chunk, .claim = claim,
                  .stack_bytes = 1 << 20, .enter = enter, .leave = leave, .stop = &t.stop};
  unsigned n_used = 99;
  ct_status status = ct_parallel(&work, n_threads, hear, NULL, &n_used);
  CHECK(n_used == t.n_threads && t.n_left == t.n_threads);
  CHECK(n_used <= (n_threads ? n_threads : 256) && (n_used > 0) == (n_items > 0));
  return status;
}

int main(void) {
  static const uint64_t items[] = {0, 1, 2, 7, 63, 64, 65, 1000, 4999}, sizes[] = {1, 3, 64};
  static const uint64_t claims[] = {0, 1, 2, 32, 1 << 20};
  for (size_t i = 0; i < sizeof items / sizeof *items; i++)
    for (size_t c = 0; c < sizeof sizes / sizeof *sizes; c++)
      for (size_t k = 0; k < sizeof claims / sizeof *claims; k++)
        for (unsigned n_threads = 0; n_threads <= 5; n_threads++) {
          CHECK(run(items[i], sizes[c], claims[k], n_threads, 0) == CT_OK);
          for (uint64_t j = 0; j < MOST; j++) CHECK(t.done[j] == (j < items[i]));
          CHECK(t.n_calls == (items[i] + sizes[c] - 1) / sizes[c]);
        }
  /* No thread begins another chunk, though it had claimed many. */
  CHECK(run(4999, 1, 1000, 3, 5) == CT_ERR_BUDGET);
  CHECK(t.n_calls >= 5 && t.n_calls <= 5 + 2);
  for (uint64_t j = 0; j < MOST; j++) CHECK(t.done[j] <= 1);
  return 0;
}
