/* Heave and pitch: gap, heave velocity (of the base's centre), pitch, pitch rate. */
#define ACCELERATIONS 2
#define SLIDES 0
#define OUTPUTS 7 /* lift_force, pitch_moment, input_force, nose_edge_force, tail_edge_force, contact, outside_table */
typedef struct {
    num force, moment, mass;
} loads;

static num arm(num pitch) { return add(times(base_depth, sine(pitch)), times(base_forward, cosine(pitch))); }
static num arm_slope(num pitch) { return sub(times(base_depth, cosine(pitch)), times(base_forward, sine(pitch))); }
static num centre_velocity(const moment *m) { return sub(m->x[1], mul(arm(m->x[2]), m->x[3])); }

static void seen(const moment *m, num *channel) {
    channels_of(m, channel);
    channel[CHANNEL_GAP] = m->x[0];
    channel[CHANNEL_HEAVE_VELOCITY] = m->x[1];
    channel[CHANNEL_PITCH] = m->x[2];
    channel[CHANNEL_PITCH_RATE] = m->x[3];
}

static void no_loads(const moment *m, loads *l) {
    num slope;
    l->force = l->moment = con(0);
    inertia(m->x[0], &l->mass, &slope);
    l->mass = plus(l->mass, terms.history * kernel.mass);
}

static void free_loads(const moment *m, loads *l) {
    const num h = m->x[0], st = sine(m->x[2]), ct = cosine(m->x[2]), reach = arm(m->x[2]), w = centre_velocity(m);
    num channel[CHANNELS], up, mass, slope;
    seen(m, channel);
    no_loads(m, l);
    up = roughened(force_at(&lift, channel), h);
    l->force = add(up, other_force(h, w, acting_input(m), channel));
    l->force = sub(l->force, water_drag(plus(w, -terms.current)));
    l->force = add(l->force, timed_force(m->t));
    if (terms.history != 0) {
        l->force = add(l->force, memory_force(w, m->x + MEMORY_AT));
    }
    l->moment = add(force_at(&pitch_moment, channel), mul(reach, up));
    l->moment = add(l->moment, times(buoyancy, add(times(buoyancy_centre[2], st), times(buoyancy_centre[0], ct))));
    l->moment = plus(l->moment, drag_moment);
    l->moment = sub(l->moment, drag_at(&drag_pitch, m->x[3]));
    if (drag.count > 0) {
        const num lever = sub(times(base_depth, ct), times(base_forward, st));
        l->moment = sub(l->moment, mul(lever, times(held_speed < 0 ? -1 : 1, force_at(&drag, channel))));
    }
    inertia(h, &mass, &slope);
    l->force = add(l->force, mul(mul(slope, w), sub(times(0.5, w), m->x[1])));
    l->moment = add(l->moment, times(0.5, mul(mul(slope, mul(w, w)), reach)));
}

/* Of the centre of gravity upward, and of the pitch. */
static void accelerations(const moment *m, const moment *slips, const loads *l, const num *normal, double friction, num *out) {
    const num st = sine(m->x[2]), ct = cosine(m->x[2]);
    num force = l->force, turn = l->moment;
    int edge;
    (void)slips;
    for (edge = 0; edge < 2; ++edge) {
        const double rx = base_forward + (edge == 0 ? half_length : -half_length),
                     along = held_speed == 0 ? 0 : held_speed > 0 ? -friction : friction;
        const num lever = add(times(rx, ct), times(base_depth, st)), low = sub(times(base_depth, ct), times(rx, st));
        force = add(force, normal[edge]);
        turn = add(turn, mul(normal[edge], add(lever, times(along, low))));
    }
    out[0] = quo(force, l->mass);
    out[1] = times(1 / pitch_inertia, turn);
}

static void gap_accelerations(const moment *m, const num *out, num *opened) {
    const num q = m->x[3], square = mul(q, q), turn = out[1];
    const num common = add(add(out[0], mul(arm(m->x[2]), turn)), mul(arm_slope(m->x[2]), square));
    const num side = times(half_length, sub(mul(cosine(m->x[2]), turn), mul(sine(m->x[2]), square)));
    opened[0] = add(common, side);
    opened[1] = sub(common, side);
}

static void edge_gaps(const moment *m, num *gap) {
    const num h = plus(m->x[0], -terms.contact_gap), rise = times(half_length, sine(m->x[2]));
    gap[0] = add(h, rise);
    gap[1] = sub(h, rise);
}
static void edge_speeds(const moment *m, num *speed) {
    const num turn = times(half_length, mul(cosine(m->x[2]), m->x[3]));
    speed[0] = add(m->x[1], turn);
    speed[1] = sub(m->x[1], turn);
}
static void stop(moment *m) { m->x[1] = m->x[3] = con(0); }
static void raise(moment *m, double by) { m->x[0].v += by; }
static void add_speeds(moment *m, const num *jump) {
    m->x[1].v += jump[0].v + arm(m->x[2]).v * jump[1].v;
    m->x[3].v += jump[1].v;
}
static int turned_round(const moment *was, const moment *is, const num *n, double friction) {
    (void)was;
    (void)is;
    (void)n;
    (void)friction;
    return 0; /* the run over the ground goes on through an impact */
}
