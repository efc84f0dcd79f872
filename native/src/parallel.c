/* Threads over chunks of items, handed out by a counter. The calling thread waits, wakes every
 * 50 ms to call back, and so can end the work within the time of one chunk. */
#define _GNU_SOURCE
#include "parallel.h"

#include <pthread.h>
#include <sched.h>
#include <time.h>
#include <unistd.h>

#include "machine.h"

enum { MAX_THREADS = 256 };

/* No thread takes more than one in so many parts of its share of what is left. */
enum { SHARES = 4 };

typedef struct crew {
  const ct_work *work;
  atomic_uint_fast64_t next, done;
  pthread_mutex_t lock;
  pthread_cond_t finished;
  unsigned n_threads, n_running;
} crew;

/* Takes the next chunks in a row; towards the end fewer, so that all threads end together. */
static int claim(crew *c, uint64_t *begin, uint64_t *end) {
  uint64_t chunk = c->work->chunk, most = c->work->claim ? c->work->claim : 1;
  *begin = atomic_load(&c->next);
  do {
    if (*begin >= c->work->n_items) return 0;
    uint64_t left = c->work->n_items - *begin, share = left / chunk / (SHARES * c->n_threads);
    uint64_t taken = (share < 1 ? 1 : share < most ? share : most) * chunk;
    *end = *begin + (taken < left ? taken : left);
  } while (!atomic_compare_exchange_weak(&c->next, begin, *end));
  return 1;
}

static void *run_thread(void *argument) {
  crew *c = argument;
  const ct_work *work = c->work;
  ct_machine_state caller = ct_machine_enter();
  void *state = work->enter ? work->enter(work->job) : NULL;
  uint64_t begin = 0, end = 0;
  while (!atomic_load(work->stop) && (begin < end || claim(c, &begin, &end))) {
    uint64_t next = end - begin < work->chunk ? end : begin + work->chunk;
    work->run(work->job, state, begin, next);
    atomic_fetch_add(&c->done, next - begin);
    begin = next;
  }
  if (work->leave) work->leave(work->job, state);
  ct_machine_leave(caller);
  pthread_mutex_lock(&c->lock);
  if (--c->n_running == 0) pthread_cond_signal(&c->finished);
  pthread_mutex_unlock(&c->lock);
  return NULL;
}

static unsigned count_cores(void) {
#if defined(__linux__)
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return (unsigned)CPU_COUNT(&allowed);
#endif
  long n = sysconf(_SC_NPROCESSORS_ONLN);
  return n > 0 ? (unsigned)n : 1;
}

static void wait_for_all(crew *c, ct_progress progress, void *user) {
  pthread_mutex_lock(&c->lock);
  while (c->n_running > 0) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += 50000000;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_cond_timedwait(&c->finished, &c->lock, &until);
    if (!progress || c->n_running == 0) continue;
    pthread_mutex_unlock(&c->lock);
    if (progress(user, atomic_load(&c->done), c->work->n_items)) {
      progress = NULL; /* it has said what it had to say */
      int running = CT_OK;
      atomic_compare_exchange_strong(c->work->stop, &running, CT_ERR_CANCELLED);
    }
    pthread_mutex_lock(&c->lock);
  }
  pthread_mutex_unlock(&c->lock);
}

ct_status ct_parallel(const ct_work *work, unsigned n_threads, ct_progress progress, void *user,
                      unsigned *n_used) {
  pthread_t threads[MAX_THREADS];
  pthread_attr_t attributes;
  uint64_t n_chunks = (work->n_items + work->chunk - 1) / work->chunk;
  unsigned n_started = 0;
  if (n_threads == 0) n_threads = count_cores();
  if (n_threads > MAX_THREADS) n_threads = MAX_THREADS;
  if (n_threads > n_chunks) n_threads = (unsigned)n_chunks;
  if (n_used) *n_used = n_threads;
  if (n_threads == 0) return CT_OK;
  crew c = {.work = work, .lock = PTHREAD_MUTEX_INITIALIZER, .finished = PTHREAD_COND_INITIALIZER,
            .n_threads = n_threads, .n_running = n_threads};
  if (pthread_attr_init(&attributes)) return CT_ERR_THREAD;
  pthread_attr_setstacksize(&attributes, work->stack_bytes);
  while (n_started < n_threads &&
         pthread_create(&threads[n_started], &attributes, run_thread, &c) == 0)
    n_started++;
  pthread_attr_destroy(&attributes);
  /* Fewer threads than wished for still do the work; none cannot. */
  pthread_mutex_lock(&c.lock);
  c.n_running -= n_threads - n_started;
  pthread_mutex_unlock(&c.lock);
  if (n_started > 0) wait_for_all(&c, progress, user);
  for (unsigned i = 0; i < n_started; i++) pthread_join(threads[i], NULL);
  pthread_cond_destroy(&c.finished);
  pthread_mutex_destroy(&c.lock);
  if (n_used) *n_used = n_started;
  return n_started ? (ct_status)atomic_load(work->stop) : CT_ERR_THREAD;
}
