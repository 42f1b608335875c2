static void derivatives(const moment *m, num *dx) {
    loads l;
    num n[2], out[ACCELERATIONS];
    lag_rates(m, dx);
    free_loads(m, &l);
    normal_forces(m, &l, 1, n);
    accelerations(m, m, &l, n, contact_friction, out);
    dx[0] = m->x[1];
    dx[1] = add(add(out[0], mul(arm(m->x[2]), out[1])), mul(arm_slope(m->x[2]), mul(m->x[3], m->x[3])));
    dx[2] = m->x[3];
    dx[3] = out[1];
    if (terms.history != 0) {
        memory_rates(centre_velocity(m), m->x + MEMORY_AT, dx + MEMORY_AT);
    }
}

static void outputs(const moment *m, num *out) {
    num channel[CHANNELS];
    loads l;
    seen(m, channel);
    free_loads(m, &l);
    out[0] = roughened(force_at(&lift, channel), m->x[0]);
    out[1] = force_at(&pitch_moment, channel);
    out[2] = acting_input(m);
    normal_forces(m, &l, 0, out + 3);
    out[5] = con(m->bearing);
    out[6] = con(is_outside(channel));
}
