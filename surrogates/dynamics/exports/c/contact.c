/* Contact of a flat base at its nose and its tail edge: gap >= 0, force >= 0, one of them zero. The motion says how loads
   and forces at the edges accelerate it. */
#define INDICATORS 2
typedef struct {
    num matrix[2][2], rest[2]; /* accelerations of the gaps = matrix * forces + rest */
} contact_problem;

static void contact_forces(const moment *m, const loads *l, double friction, contact_problem *p) {
    num none[2], out[ACCELERATIONS], opened[2];
    int edge, i;
    none[0] = none[1] = con(0);
    accelerations(m, m, l, none, friction, out);
    gap_accelerations(m, out, p->rest);
    for (edge = 0; edge < 2; ++edge) {
        num unit[2];
        unit[edge] = con(1);
        unit[1 - edge] = con(0);
        accelerations(m, m, l, unit, friction, out);
        gap_accelerations(m, out, opened);
        for (i = 0; i < 2; ++i) {
            p->matrix[i][edge] = sub(opened[i], p->rest[i]);
        }
    }
}

static void holding_forces(const contact_problem *p, int bearing, num *n) {
    n[0] = n[1] = con(0);
    if (bearing == 3) {
        const num determinant =
            sub(mul(p->matrix[0][0], p->matrix[1][1]), mul(p->matrix[0][1], p->matrix[1][0]));
        n[0] = quo(sub(mul(p->rest[1], p->matrix[0][1]), mul(p->rest[0], p->matrix[1][1])), determinant);
        n[1] = quo(sub(mul(p->rest[0], p->matrix[1][0]), mul(p->rest[1], p->matrix[0][0])), determinant);
    } else if (bearing == 1 || bearing == 2) {
        n[bearing - 1] = times(-1, quo(p->rest[bearing - 1], p->matrix[bearing - 1][bearing - 1]));
    }
}

/* The complementary state among the candidates; -1: none. */
static int contact_state(const contact_problem *p, int candidates) {
    static const int order[4] = {0, 3, 1, 2};
    const double r0 = fabs(p->rest[0].v), r1 = fabs(p->rest[1].v), larger = r0 > r1 ? r0 : r1,
                 size = larger > 1e-12 ? larger : 1e-12;
    int i, e;
    for (i = 0; i < 4; ++i) {
        const int state = order[i];
        num n[2];
        int good = (state & ~candidates) == 0;
        holding_forces(p, state, n);
        for (e = 0; e < 2 && good; ++e) {
            if (state >> e & 1) {
                good = n[e].v >= -1e-12;
            } else if (candidates >> e & 1) {
                good = p->matrix[e][0].v * n[0].v + p->matrix[e][1].v * n[1].v + p->rest[e].v >= -1e-10 * size;
            }
        }
        if (good) {
            return state;
        }
    }
    return -1;
}

/* Forces at the edges that bear; `pull` draws a held edge that has drifted back onto the ground. */
static void normal_forces(const moment *m, const loads *l, int pull, num *n) {
    contact_problem p;
    num gap[2], speed[2];
    int i;
    n[0] = n[1] = con(0);
    if (!m->bearing) {
        return;
    }
    contact_forces(m, l, contact_friction, &p);
    edge_gaps(m, gap);
    edge_speeds(m, speed);
    for (i = 0; i < 2 && pull; ++i) {
        p.rest[i] = add(p.rest[i], add(times(40, speed[i]), times(400, gap[i])));
    }
    holding_forces(&p, m->bearing, n);
}

static void indicators(const moment *m, double *z) {
    loads l;
    num n[2], gap[2];
    int e;
    free_loads(m, &l);
    normal_forces(m, &l, 0, n);
    edge_gaps(m, gap);
    for (e = 0; e < 2; ++e) {
        z[e] = (m->bearing >> e & 1) ? n[e].v : gap[e].v;
    }
}

/* The motion after an impact with this friction; 0 where it contradicts itself or turns a slip round. */
static int struck_with(const moment *m, int touching, double friction, moment *after) {
    moment still = *m;
    loads none;
    contact_problem p;
    num speed[2], n[2], jump[ACCELERATIONS];
    int edge, i, state;
    stop(&still);
    no_loads(m, &none);
    edge_speeds(m, speed);
    for (edge = 0; edge < 2; ++edge) {
        num unit[2], opened[2];
        unit[edge] = con(1);
        unit[1 - edge] = con(0);
        accelerations(&still, m, &none, unit, friction, jump);
        gap_accelerations(&still, jump, opened);
        p.rest[edge] = times(speed[edge].v < 0 ? 1 + terms.restitution : 1, speed[edge]);
        for (i = 0; i < 2; ++i) {
            p.matrix[i][edge] = opened[i];
        }
    }
    state = contact_state(&p, touching);
    if (state < 0) {
        return 0;
    }
    holding_forces(&p, state, n);
    accelerations(&still, m, &none, n, friction, jump);
    *after = *m;
    add_speeds(after, jump);
    return !turned_round(m, after, n, friction);
}

static int impact(moment *m, int touching) {
    moment after;
    double least = 0, most = contact_friction;
    int i;
    if (struck_with(m, touching, most, &after)) {
        *m = after;
        return 1;
    }
    if (!struck_with(m, touching, 0, &after)) {
        return 0;
    }
    for (i = 0; i < 60 && SLIDES && most - least > 1e-12 * contact_friction; ++i) {
        const double middle = (least + most) / 2;
        moment sticks;
        if (struck_with(m, touching, middle, &sticks)) {
            least = middle;
            after = sticks;
        } else {
            most = middle;
        }
    }
    *m = after;
    return 1;
}

/* What the ground does to the body; 1 when states changed, -1 when that has no solution. */
static int meet_ground(moment *m) {
    const int before = m->bearing;
    int e, struck = 0, touching = 0, strikes = 0, raised;
    num gap[2], speed[2];
    double deepest;
    edge_gaps(m, gap);
    deepest = gap[0].v < gap[1].v ? gap[0].v : gap[1].v;
    raised = deepest < 0;
    if (raised) {
        raise(m, -deepest);
    }
    edge_gaps(m, gap);
    edge_speeds(m, speed);
    for (e = 0; e < 2; ++e) {
        struck |= gap[e].v <= 1e-8 ? 1 << e : 0;
        strikes = strikes || (gap[e].v <= 1e-8 && speed[e].v < -1e-7);
    }
    if (strikes) {
        if (!impact(m, struck)) {
            return -1;
        }
        edge_speeds(m, speed);
    }
    for (e = 0; e < 2; ++e) {
        touching |= (struck >> e & 1) && speed[e].v <= 1e-7 ? 1 << e : 0;
    }
    m->bearing = 0;
    if (touching) {
        contact_problem p;
        loads l;
        free_loads(m, &l);
        contact_forces(m, &l, contact_friction, &p);
        m->bearing = contact_state(&p, touching);
    }
    return m->bearing < 0 ? -1 : raised || strikes || m->bearing != before;
}
