/* Heave: gap and heave velocity. */
#define INDICATORS 1
#define OUTPUTS 4 /* lift_force, input_force, contact, outside_table */
static const double slowest_bounce = 1e-5;

static num lift_of(const moment *m, num *channel) {
    channels_of(m, channel);
    channel[CHANNEL_GAP] = m->x[0];
    channel[CHANNEL_HEAVE_VELOCITY] = m->x[1];
    return roughened(force_at(&lift, channel), m->x[0]);
}

static num acceleration(const moment *m, int with_memory) {
    const num h = m->x[0], w = m->x[1];
    num channel[CHANNELS], force = lift_of(m, channel), mass, slope;
    force = add(force, other_force(h, w, acting_input(m), channel));
    force = add(force, timed_force(m->t));
    force = sub(force, water_drag(plus(w, -terms.current)));
    inertia(h, &mass, &slope);
    if (with_memory && terms.history != 0) {
        force = add(force, memory_force(w, m->x + MEMORY_AT));
        mass = plus(mass, terms.history * kernel.mass);
    }
    return quo(sub(force, times(0.5, mul(slope, mul(w, w)))), mass);
}

static void derivatives(const moment *m, num *dx) {
    int i;
    for (i = 0; i < STATES; ++i) {
        dx[i] = con(0);
    }
    lag_rates(m, dx);
    if (m->bearing) {
        return;
    }
    dx[0] = m->x[1];
    dx[1] = acceleration(m, 1);
    if (terms.history != 0) {
        memory_rates(m->x[1], m->x + MEMORY_AT, dx + MEMORY_AT);
    }
}

static void outputs(const moment *m, num *out) {
    num channel[CHANNELS];
    out[0] = lift_of(m, channel);
    out[1] = acting_input(m);
    out[2] = con(m->bearing);
    out[3] = con(is_outside(channel));
}

static double lifting(const moment *m) {
    moment still = *m;
    still.x[0] = con(terms.contact_gap);
    still.x[1] = con(0);
    return acceleration(&still, 0).v;
}

static void indicators(const moment *m, double *z) { z[0] = m->bearing ? -lifting(m) : m->x[0].v - terms.contact_gap; }

static num centre_velocity(const moment *m) { return m->x[1]; }

/* What the ground does to the body; 1 when states changed, -1 when that has no solution. */
static int meet_ground(moment *m) {
    const double h = m->x[0].v, w = m->x[1].v;
    if (!m->bearing) {
        if (h > terms.contact_gap + 1e-12 || w > 0 || (w == 0 && lifting(m) > 0)) {
            return 0;
        }
        m->x[0].v = terms.contact_gap;
        m->x[1].v = -terms.restitution * w;
        if (m->x[1].v >= slowest_bounce) {
            return 1;
        }
        m->x[1].v = 0;
        m->bearing = 1;
    }
    if (lifting(m) > 0) {
        m->bearing = 0;
        m->x[1].v = 1e-12;
    }
    return 1;
}
