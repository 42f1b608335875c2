/* Of u, v, w, q, r under loads and forces at the edges, which slip as `slips` says. */
static void accelerations(const moment *m, const moment *slips, const loads *given, const num *normal, double friction, num *out) {
    const num st = sine(m->x[THETA]), ct = cosine(m->x[THETA]), tt = quo(st, ct);
    num momentum[3], turn[3], speed[3], spin[3], swept[3], gyration[3], munk[3], rest[3], own, a11, a12, a22, b2, determinant;
    loads l = *given;
    int edge, i;
    for (edge = 0; edge < 2; ++edge) {
        double at[3];
        num sx, sy, size, n = normal[edge];
        if (n.v == 0 && n.d == 0) {
            continue;
        }
        edge_place(edge, at);
        slip_of(slips, edge, &sx, &sy);
        size = root(plus(add(mul(sx, sx), mul(sy, sy)), slip_speed * slip_speed));
        load_upward(&l, at, slips, n, times(-friction, mul(n, quo(sx, size))), times(-friction, mul(n, quo(sy, size))));
    }
    turn[0] = roll_rate(m);
    turn[1] = m->x[Q];
    turn[2] = m->x[R];
    for (i = 0; i < 3; ++i) {
        speed[i] = m->x[U + i];
        swept[i] = gyration[i] = munk[i] = con(0);
        spin[i] = add(times(inertia_of[i][0], turn[0]), add(times(inertia_of[i][1], turn[1]), times(inertia_of[i][2], turn[2])));
    }
    momentum[0] = times(mass_x, speed[0]);
    momentum[1] = times(mass_y, speed[1]);
    momentum[2] = mul(l.mass, speed[2]);
    cross_to(turn, momentum, swept);
    cross_to(turn, spin, gyration);
    cross_to(speed, momentum, munk);
    out[0] = times(1 / mass_x, sub(l.force[0], swept[0]));
    out[1] = times(1 / mass_y, sub(l.force[1], swept[1]));
    out[2] = quo(sub(l.force[2], swept[2]), l.mass);
    /* p' = -r' tan(theta) - r q/cos^2(theta): what roll held at zero adds of itself. */
    own = times(-1, quo(mul(turn[2], turn[1]), mul(ct, ct)));
    for (i = 0; i < 3; ++i) {
        rest[i] = sub(sub(sub(l.moment[i], gyration[i]), munk[i]), times(inertia_of[i][0], own));
    }
    /* Along the motions (0, 1, 0) and (-tan(theta), 0, 1) the moment that holds roll does no work. */
    a11 = con(inertia_of[1][1]);
    a12 = plus(times(-inertia_of[0][1], tt), inertia_of[1][2]);
    a22 = plus(add(times(-2 * inertia_of[0][2], tt), times(inertia_of[0][0], mul(tt, tt))), inertia_of[2][2]);
    b2 = sub(rest[2], mul(tt, rest[0]));
    determinant = sub(mul(a11, a22), mul(a12, a12));
    out[3] = quo(sub(mul(rest[1], a22), mul(a12, b2)), determinant);
    out[4] = quo(sub(mul(a11, b2), mul(a12, rest[1])), determinant);
}

static void gap_accelerations(const moment *m, const num *a, num *opened) {
    const num st = sine(m->x[THETA]), ct = cosine(m->x[THETA]), q = m->x[Q], square = mul(q, q);
    const num down = add(sub(mul(a[2], ct), mul(a[0], st)),
                         times(-1, mul(q, add(mul(m->x[U], ct), mul(m->x[W], st)))));
    const num lever = sub(times(base_place[2], ct), times(base_place[0], st));
    const num common = add(sub(mul(lever_of(m), a[3]), down), mul(lever, square));
    const num turn = times(half_length, sub(mul(ct, a[3]), mul(st, square)));
    opened[0] = add(common, turn);
    opened[1] = sub(common, turn);
}

static void edge_gaps(const moment *m, num *gap) {
    const num h = plus(gap_of(m), -terms.contact_gap), rise = times(half_length, sine(m->x[THETA]));
    gap[0] = add(h, rise);
    gap[1] = sub(h, rise);
}
static void edge_speeds(const moment *m, num *speed) {
    const num up = rise_of_base(m), turn = times(half_length, mul(cosine(m->x[THETA]), m->x[Q]));
    speed[0] = add(up, turn);
    speed[1] = sub(up, turn);
}
static void stop(moment *m) { m->x[U] = m->x[V] = m->x[W] = m->x[Q] = m->x[R] = con(0); }
static void raise(moment *m, double by) { m->x[Z].v -= by; }
static void add_speeds(moment *m, const num *jump) {
    int i;
    for (i = 0; i < 5; ++i) {
        m->x[U + i].v += jump[i].v;
    }
}
/* Friction stops a slip, it does not turn it round. */
static int turned_round(const moment *was, const moment *is, const num *n, double friction) {
    int edge, turned = 0;
    for (edge = 0; edge < 2 && friction > 0; ++edge) {
        num ax, ay, bx, by;
        slip_of(was, edge, &ax, &ay);
        slip_of(is, edge, &bx, &by);
        turned = turned || (n[edge].v > 0 && ax.v * bx.v + ay.v * by.v < 0);
    }
    return turned;
}
