/* Saved runs: all that a run needs to go on as if it had not stopped. */

enum { COUNTING, SAVING, RESTORING };

/* Bytes that are counted, written or read, from front to back. */
typedef struct {
  unsigned char *front;
  size_t used;
  int way;
} passage;

static void pass(passage *all, void *value, size_t size) {
  if (all->way == SAVING) memcpy(all->front + all->used, value, size);
  if (all->way == RESTORING) memcpy(value, all->front + all->used, size);
  all->used += size;
}

static void pass_reals(passage *all, double *values, whole count) { pass(all, values, (size_t)count * sizeof *values); }
static void pass_wholes(passage *all, whole *values, whole count) { pass(all, values, (size_t)count * sizeof *values); }

#define PASS(name) pass(all, &run->m.name, sizeof run->m.name);
static void pass_run(ltcgear_run *run, passage *all) {
  const ltcgear_model *model = run->model;
  march *m = &run->m;
  const whole n = m->n, meshes = m->n_levels, holds = m->n_holds;
  KEPT_NUMBERS(PASS)
  PASS(base) PASS(rtol) PASS(unresolved) PASS(held_speed) PASS(shortest)
  pass(all, &run->turns, sizeof run->turns), pass(all, &run->started, sizeof run->started);
  pass(all, &run->quickest, sizeof run->quickest);
  pass_reals(all, m->z, n), pass_reals(all, m->origin, n), pass_reals(all, m->scale, n);
  pass_reals(all, m->p, model->n_parameters), pass_reals(all, run->parameters, model->n_parameters);
  pass_reals(all, m->signals, m->n_signals), pass_reals(all, m->slope, m->n_signals);
  pass_reals(all, m->heading, meshes), pass_reals(all, m->lowest, m->n_forces);
  pass_reals(all, m->error, n * holds), pass_reals(all, m->slack, holds);
  pass_wholes(all, m->cells, meshes), pass_wholes(all, m->last_turn, meshes);
  pass_wholes(all, m->arc_cells, meshes);
  pass_wholes(all, run->rest, model->n_clocks), pass_wholes(all, run->cycles, model->n_clocks);
  pass(all, m->sides, (size_t)holds), pass(all, run->courses, (size_t)model->n_tables * sizeof *run->courses);
}
#undef PASS

/* The bytes that a saved run begins with: its model's key. */
static size_t key_size(const ltcgear_run *run) { return strlen(run->model->key) + 1; }

/* All bytes but those of the checksum. */
static size_t sealed_size(const ltcgear_run *run) {
  passage all = {0, key_size(run), COUNTING};
  pass_run((ltcgear_run *)run, &all); /* which is only read */
  return all.used;
}

unsigned long long ltcgear_checksum(const void *bytes, size_t size) {
  unsigned long long sum = 0xcbf29ce484222325u;
  for (const unsigned char *c = bytes, *end = c + size; c < end; ++c) sum = (sum ^ *c) * 0x100000001b3u;
  return sum;
}

size_t ltcgear_size(const ltcgear_run *run) { return sealed_size(run) + sizeof(unsigned long long); }

void ltcgear_save(const ltcgear_run *run, void *to) {
  passage all = {to, key_size(run), SAVING};
  memcpy(to, run->model->key, key_size(run));
  pass_run((ltcgear_run *)run, &all); /* which is only read */
  unsigned long long sum = ltcgear_checksum(to, all.used);
  pass(&all, &sum, sizeof sum);
}

int ltcgear_restore(ltcgear_run *run, const void *from) {
  passage all = {(unsigned char *)from, key_size(run), RESTORING}; /* which is only read */
  const size_t size = sealed_size(run);
  unsigned long long sum = ltcgear_checksum(from, size);
  if (memcmp(from, run->model->key, key_size(run))) return FOREIGN;
  if (memcmp(all.front + size, &sum, sizeof sum)) return DAMAGED;
  pass_run(run, &all);
  return DONE;
}
