/* The start of a run: its equilibrium, scale, cells and sides there. */

/* Write the indicators of borders at displacements z. */
static void borders_at(march *m, const double *z, double *out) {
  place(m, z);
  m->borders.res[0] = out;
  call(&m->borders, m->x, m->s_now, m->p);
}

/* Set the sides of all borders, and what the tolerance of each state lets their indicators be off. */
static void set_sides(ltcgear_run *run) {
  march *m = &run->m;
  const int known = m->angle >= 0 && m->free < 0;
  for (whole i = 0; i < m->n_levels; ++i) m->s_now[i] = (double)(m->cells[i] & 1);
  memcpy(m->s_now + m->n_levels, m->signals, (size_t)m->n_signals * sizeof *m->signals);
  borders_at(m, m->zeros, m->g_start);
  for (whole g = 0; g < m->n_holds; ++g) m->sides[g] = m->g_start[g] > 0, m->slack[g] = 0;
  memset(m->z_near, 0, (size_t)m->n * sizeof *m->z_near);
  for (whole i = 0; m->n_holds && i < m->n; ++i) {
    m->z_near[i] = 1;
    borders_at(m, m->z_near, m->g_now);
    m->z_near[i] = 0;
    for (whole g = 0; g < m->n_holds; ++g) {
      double off = known && i == m->angle ? 0 : SLACK * m->rtol * fabs(m->g_now[g] - m->g_start[g]);
      m->error[i * m->n_holds + g] = off;
      m->slack[g] = larger(m->slack[g], off);
    }
  }
  hold(m);
}

/* Set the cells of all meshes. */
static void set_cells(march *m) {
  const whole count = m->n_levels;
  find_phases(m, m->zeros, m->signals, m->now);
  for (whole i = 0; i < count; ++i)
    m->cells[i] = m->last_turn[i] = m->arc_cells[i] = cell_of(m->now[i], m->now[count + i], m->now[2 * count + i]);
}

/* Find equilibrium and scale, in room that is freed again. */
static int find_start(ltcgear_run *run) {
  const whole n = run->model->n_states;
  balance b = {.run = run};
  double *matrix, *square;
  room r = {0, 0};
  for (int counted = 0; counted < 2; ++counted) {
    if (counted) r = (room){calloc(1, r.used), 0};
    if (counted && !r.front) return NO_MEMORY;
    lay_out_balance(&b, &r);
    matrix = reals(&r, n * n), square = reals(&r, n * n);
  }
  int fault = find_equilibrium(&b);
  if (!fault) fault = set_scale(&b, matrix, square);
  memcpy(run->m.origin, b.x, (size_t)n * sizeof *b.x);
  free(r.front);
  return fault;
}

int ltcgear_start(ltcgear_run *run, double time) {
  const ltcgear_model *model = run->model;
  march *m = &run->m;
  int fault;
  if (run->started) return HAS_STARTED;
  if (!isfinite(time)) return NOT_A_NUMBER;
  m->time = time;
  memcpy(m->p, run->parameters, (size_t)model->n_parameters * sizeof *m->p);
  m->held_speed = model->speed_held ? m->p[model->speed] : 0;
  if ((fault = find_start(run))) return fault;
  m->first = m->longest = m->widest = TURNED / larger(run->quickest, SLOWEST);
  m->shortest = SHORTEST * m->longest, m->fresh = 1;
  signals_at(run, time, 1, m->signals);
  set_cells(m);
  set_sides(run);
  for (whole i = 0; i < m->n_forces; ++i) m->lowest[i] = INFINITY;
  run->started = 1;
  return DONE;
}
