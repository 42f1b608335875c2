static void derivatives(const moment *m, num *dx) {
    const num st = sine(m->x[THETA]), ct = cosine(m->x[THETA]), sp = sine(m->x[PSI]), cp = cosine(m->x[PSI]);
    const num level = add(mul(m->x[U], ct), mul(m->x[W], st));
    loads l;
    num n[2];
    int i;
    lag_rates(m, dx);
    free_loads(m, &l);
    normal_forces(m, &l, 1, n);
    accelerations(m, m, &l, n, contact_friction, dx);
    dx[THETA] = m->x[Q];
    dx[PSI] = quo(m->x[R], ct);
    dx[X] = sub(mul(level, cp), mul(m->x[V], sp));
    dx[Y] = add(mul(level, sp), mul(m->x[V], cp));
    dx[Z] = down_velocity(m);
    for (i = 0; i < JETS; ++i) {
        if (jets[i].state >= 0) {
            const num wanted = between(m->u[1 + i], jets[i].minimum, jets[i].maximum);
            dx[jets[i].state] = times(1 / jets[i].lag, sub(wanted, m->x[jets[i].state]));
        }
    }
    if (terms.history != 0) {
        memory_rates(centre_velocity(m), m->x + MEMORY_AT, dx + MEMORY_AT);
    }
}

static void outputs(const moment *m, num *out) {
    num channel[CHANNELS], level[CHANNELS];
    loads l;
    seen(m, channel);
    free_loads(m, &l);
    out[0] = channel[CHANNEL_GAP];
    out[1] = channel[CHANNEL_HEAVE_VELOCITY];
    out[2] = roll_rate(m);
    table_loads(channel, out + 3, out + 4, out + 5, level);
    out[6] = acting_input(m);
    normal_forces(m, &l, 0, out + 7);
    out[9] = con(m->bearing);
    out[10] = con(is_outside(channel));
}
