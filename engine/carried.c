/* Derivatives of the motion by several unknowns, carried along with it. Included behind engine.c.
 *
 * Between events they are those of the step itself: each stage of Dormand and Prince's pair takes the slopes of the
 * right-hand side at the stage of the motion. At an event of surface g the time of the event moves by
 * dt = -dg / (dg/dt) and the derivative jumps by (f- - f+) dt (the saltation matrix: Aizerman and Gantmacher 1958;
 * Hiskens and Pai 2000); where the motion stops on the surface its velocity is put to zero before it goes on with f+.
 * While the motion is held displacement and velocity have no rate; the inner states go on. Changes at an instant that is
 * given (a force that jumps, a correction) have dt = 0, and what an event brings about at once has its dt. */

/* Events so close together, in internal steps, are one: an event is located to 1e-13 of a step. */
#define DP_SAME 1e-9

/* Held by nothing: a motion at rest without friction and force, which any unknown would move. */
static int dp_carry_loose(const dp_engine *e, const dp_line *l, double tau) {
    double rest;
    return dp_capacity(e, l, tau, e->z, e->hold, &rest) == 0.0;
}

static int dp_carry_held(const dp_engine *e, const dp_line *l, double tau) {
    return e->hold >= 0 && !dp_carry_loose(e, l, tau);
}

/* What the motion that is held weighs, its derivatives, and those of what each surface carries of it. A motion that
 * flies held to where it breaks away is beyond what holds it at the last stages, by rounding: the share has its slope
 * there too. */
typedef struct {
    double rest, capacity;
    double drest[DP_LANES], dcapacity[DP_LANES], dshare[DP_LANES];
    int joined[DP_NS + 1];
} dp_balance;

static void dp_carry_balance(const dp_engine *e, const dp_line *l, double tau, const double *z,
                             const double (*dz)[DP_LANES], const int *which, dp_balance *b) {
    double s[DP_NS + 1], f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], slopes[DP_FIELD_SLOPES];
    double pushed[DP_FIELD_PUSHED][DP_LANES], df[DP_LANES];
    const double t = l->t0 + tau, u = dp_force(l, tau);
    int j, k;
    memset(b, 0, sizeof *b);
    memcpy(s, e->s, sizeof s);
    dp_surface(z, t, u, dp_force_rate(l, tau), e->p, s, f, g, gd);
    for (j = 0; j < DP_NS; ++j) {
        b->joined[j] = j == e->hold || (dp_kind[j] == DP_POSITION && g[j] == 0.0);
        if (b->joined[j]) s[j] = 0.0;
    }
    dp_field(z, t, u, e->p, s, f);
    b->rest = f[1];
    dp_field_slopes(z, t, u, e->p, s, slopes);
    dp_field_pushes(slopes, which, pushed);
    dp_field_along(slopes, pushed, dz, 1, b->drest);
    for (j = 0; j < DP_NS; ++j) {
        double part;
        if (!b->joined[j]) continue;
        s[j] = 1.0;
        dp_field(z, t, u, e->p, s, f);
        part = b->rest - f[1];
        if (j == e->hold || part > 0.0) {
            dp_field_slopes(z, t, u, e->p, s, slopes);
            dp_field_pushes(slopes, which, pushed);
            dp_field_along(slopes, pushed, dz, 1, df);
            b->capacity += part;
            for (k = 0; k < DP_LANES; ++k) b->dcapacity[k] += b->drest[k] - df[k];
        }
        s[j] = 0.0;
    }
    if (b->capacity > 0.0)
        for (k = 0; k < DP_LANES; ++k)
            b->dshare[k] = (b->drest[k] - b->rest / b->capacity * b->dcapacity[k]) / b->capacity;
}

/* Rates of the derivatives while the motion is held. */
static void dp_carry_rest(const dp_engine *e, const dp_line *l, double tau, const double *z,
                          const double (*dz)[DP_LANES], const int *which, double (*out)[DP_LANES]) {
    double s[DP_NS + 1], slopes[DP_FIELD_SLOPES], pushed[DP_FIELD_PUSHED][DP_LANES];
    const double t = l->t0 + tau, u = dp_force(l, tau);
    int k, n;
    memcpy(s, e->s, sizeof s);
    if (DP_RATES_FEEL_REST) dp_shares(e, l, tau, z, s);
    dp_field_slopes(z, t, u, e->p, s, slopes);
    dp_field_pushes(slopes, which, pushed);
    for (n = 2; n < DP_NZ; ++n) dp_field_along(slopes, pushed, dz, n, out[n]);
    memset(out[0], 0, sizeof out[0]);
    memset(out[1], 0, sizeof out[1]);
    if (DP_RATES_FEEL_REST) {
        double by[DP_NZ * DP_NS + 1];
        dp_balance b;
        int j;
        dp_carry_balance(e, l, tau, z, dz, which, &b);
        dp_field_by_signs(z, t, u, e->p, s, by);
        for (j = 0; j < DP_NS; ++j)
            for (n = 2; b.joined[j] && n < DP_NZ; ++n)
                for (k = 0; k < DP_LANES; ++k) out[n][k] += by[n + DP_NZ * j] * b.dshare[k];
    }
}

/* One step of a block of derivatives, with the slopes at the stages of the motion. */
DP_INLINE void dp_carry_block(double (*slopes)[DP_FIELD_SLOPES], const int *which, double h, double (*dz)[DP_LANES]) {
    double pushed[6][DP_FIELD_PUSHED][DP_LANES], k[6][DP_NZ][DP_LANES], y[DP_NZ][DP_LANES];
    int i, j, n, m;
    for (i = 0; i < 6; ++i) dp_field_pushes(slopes[i], which, pushed[i]);
    memcpy(y, dz, sizeof y);
    DP_UNROLL
    for (i = 0; i < 6; ++i) {
        DP_UNROLL
        for (n = 0; n < DP_NZ; ++n) dp_field_along(slopes[i], pushed[i], y, n, k[i][n]);
        DP_UNROLL
        for (n = 0; n < DP_NZ; ++n) {
            for (m = 0; m < DP_LANES; ++m) {
                double sum = 0.0;
                DP_UNROLL
                for (j = 0; j <= i; ++j) sum += dp_weight[i][j] * k[j][n][m];
                y[n][m] = dz[n][m] + h * sum;
            }
        }
    }
    memcpy(dz, y, sizeof y);
}

/* The same while the motion is held. */
static void dp_carry_block_held(const dp_engine *e, const dp_line *l, double tau, double h, int block) {
    const dp_carried *c = DP_CARRIED(e);
    double k[6][DP_NZ][DP_LANES], y[DP_NZ][DP_LANES];
    int i, j, n, m;
    memcpy(y, c->dz[block], sizeof y);
    for (i = 0; i < 6; ++i) {
        dp_carry_rest(e, l, tau + dp_node[i] * h, c->stage[i], (const double(*)[DP_LANES])y, c->which[block], k[i]);
        for (n = 0; n < DP_NZ; ++n) {
            for (m = 0; m < DP_LANES; ++m) {
                double sum = 0.0;
                for (j = 0; j <= i; ++j) sum += dp_weight[i][j] * k[j][n][m];
                y[n][m] = c->dz[block][n][m] + h * sum;
            }
        }
    }
    memcpy(c->dz[block], y, sizeof y);
}

/* A motion that is held on the seat of a position surface, from beside which the forces would push it back: no unknown
 * moves it off, it goes with the seat. */
static void dp_carry_seats(const dp_engine *e, const dp_line *l, double tau) {
    const dp_carried *c = DP_CARRIED(e);
    const double t = l->t0 + tau, u = dp_force(l, tau);
    double s[DP_NS + 1], f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], rest, slopes[DP_SURFACE_SLOPES], slope[DP_LANES];
    double pushed[DP_SURFACE_PUSHED][DP_LANES], aside[DP_NZ][DP_LANES], dg[DP_LANES];
    const double capacity = dp_capacity(e, l, tau, e->z, e->hold, &rest);
    int b, j, k;
    dp_surface(e->z, t, u, dp_force_rate(l, tau), e->p, e->s, f, g, gd);
    for (j = 0; j < DP_NS; ++j) {
        double part;
        if (dp_kind[j] != DP_POSITION || g[j] != 0.0) continue;
        memcpy(s, e->s, sizeof s); /* those that the motion rests on are zero in it */
        s[j] = 1.0;
        dp_field(e->z, t, u, e->p, s, f);
        s[j] = -1.0;
        part = -f[1];
        dp_field(e->z, t, u, e->p, s, f);
        part = 0.5 * (part + f[1]);
        if (part <= 0.0 || fabs(rest) + part <= capacity - part) continue; /* friction would hold it beside the seat */
        dp_surface_slopes(e->z, t, u, e->p, e->s, slopes);
        memset(aside, 0, sizeof aside);
        memset(pushed, 0, sizeof pushed);
        aside[0][0] = 1.0;
        dp_surface_along(slopes, pushed, (const double(*)[DP_LANES])aside, j, slope);
        for (b = 0; b < c->blocks; ++b) {
            dp_surface_pushes(slopes, c->which[b], pushed);
            dp_surface_along(slopes, pushed, (const double(*)[DP_LANES])c->dz[b], j, dg);
            for (k = 0; k < DP_LANES; ++k) c->dz[b][0][k] -= dg[k] / slope[0];
        }
    }
}

/* The motion has flown over h from e->z at tau, where its right-hand side was k1. */
DP_WIDE DP_APART void dp_carry_flow(const dp_engine *e, const dp_line *l, double tau, double h,
                                    const double *k1) {
    dp_carried *c = DP_CARRIED(e);
    double slopes[6][DP_FIELD_SLOPES], sides[DP_SIDES];
    int i, b;
    if (h <= 0.0) return;
    if (c->stage_tau != tau || c->stage_h != h) { /* what was tried last was another length */
        double end[DP_NZ];
        dp_step(e, l, tau, h, e->z, k1, end);
    }
    memcpy(c->stage[0], e->z, sizeof e->z);
    if (h > DP_SAME * e->max_step) memset(c->shift, 0, c->blocks * sizeof *c->shift);
    if (e->hold >= 0 && dp_carry_held(e, l, tau)) {
        dp_carry_seats(e, l, tau);
        for (b = 0; b < c->blocks; ++b) {
            memset(c->dz[b][1], 0, sizeof c->dz[b][1]);
            if (DP_NZ > 2) dp_carry_block_held(e, l, tau, h, b);
        }
        return;
    }
    i = 2; /* within the step; its ends may be on a kink */
    dp_sides(c->stage[i], l->t0 + (tau + dp_node[i] * h), dp_force(l, tau + dp_node[i] * h), e->p, e->s, sides);
    for (i = 0; i < 6; ++i) {
        const double at = tau + dp_node[i] * h;
        dp_field_slopes_here(c->stage[i], l->t0 + at, dp_force(l, at), e->p, e->s, sides, slopes[i]);
    }
    for (b = 0; b < c->blocks; ++b) dp_carry_block(slopes, c->which[b], h, c->dz[b]);
}

/* Right-hand side as the derivatives take it. */
static void dp_carry_rates(const dp_engine *e, const dp_line *l, double tau, double *f) {
    dp_field(e->z, l->t0 + tau, dp_force(l, tau), e->p, e->s, f);
    if (dp_carry_held(e, l, tau)) dp_hold_rates(e, l, tau, e->z, f);
}

/* Something changes at the present instant. */
static void dp_carry_before(const dp_engine *e, const dp_line *l, double tau, int stops) {
    dp_carried *c = DP_CARRIED(e);
    dp_carry_rates(e, l, tau, c->before);
    c->held = e->hold >= 0;
    c->stops = stops;
}

/* The motion, on a surface, is about to cross it. Where it is beyond the surface already, this has jumped in an event
 * (as the force of a contact does that a saturation takes in) and comes with that event, when that comes. */
static void dp_carry_crossing(const dp_engine *e, const dp_line *l, double tau, int surface) {
    dp_carried *c = DP_CARRIED(e);
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], slopes[DP_SURFACE_SLOPES], pushed[DP_SURFACE_PUSHED][DP_LANES];
    double beside[DP_NZ][DP_LANES], dg[DP_LANES], rate;
    int b, k, n;
    dp_carry_before(e, l, tau, dp_kind[surface] == DP_VELOCITY);
    dp_surface(e->z, l->t0 + tau, dp_force(l, tau), dp_force_rate(l, tau), e->p, e->s, f, g, gd);
    dp_surface_slopes(e->z, l->t0 + tau, dp_force(l, tau), e->p, e->s, slopes);
    memset(beside, 0, sizeof beside);
    memset(pushed, 0, sizeof pushed);
    for (n = 0; n < DP_NZ; ++n) beside[n][0] = c->before[n] - f[n]; /* of a held motion, whose rates are others */
    dp_surface_along(slopes, pushed, (const double(*)[DP_LANES])beside, surface, dg);
    rate = gd[surface] + dg[0];
    if (dp_kind[surface] == DP_OTHER && fabs(g[surface]) > DP_SAME * e->max_step * fabs(rate)) return;
    for (b = 0; b < c->blocks; ++b) {
        dp_surface_pushes(slopes, c->which[b], pushed);
        dp_surface_along(slopes, pushed, (const double(*)[DP_LANES])c->dz[b], surface, dg);
        for (k = 0; k < DP_LANES; ++k) c->shift[b][k] = rate != 0.0 ? -dg[k] / rate : 0.0;
    }
}

/* The held motion is about to break away, for the forces have grown to what holds it. */
static void dp_carry_breaking(const dp_engine *e, const dp_line *l, double tau) {
    dp_carried *c = DP_CARRIED(e);
    const double t = l->t0 + tau, u = dp_force(l, tau), way = dp_force_rate(l, tau);
    double s[DP_NS + 1], base = 0.0, one, rate = 0.0;
    int b, j, k;
    dp_balance held;
    dp_carry_before(e, l, tau, 0);
    for (b = 0; b < c->blocks; ++b) {
        const double side = (dp_carry_balance(e, l, tau, e->z, (const double(*)[DP_LANES])c->dz[b], c->which[b], &held),
                             held.rest >= 0.0 ? 1.0 : -1.0);
        if (b == 0) { /* how fast the forces exceed it */
            for (j = 0; j < DP_NS; ++j) s[j] = held.joined[j] ? 0.0 : e->s[j];
            dp_drift(e->z, t, u, e->p, s, c->before, way, &base);
            rate = side * base;
            for (j = 0; j < DP_NS; ++j) {
                double f[DP_NZ];
                if (!held.joined[j]) continue;
                s[j] = 1.0;
                dp_field(e->z, t, u, e->p, s, f);
                dp_drift(e->z, t, u, e->p, s, c->before, way, &one);
                s[j] = 0.0;
                if (j == e->hold || held.rest - f[1] > 0.0) rate -= base - one;
            }
        }
        for (k = 0; k < DP_LANES; ++k)
            c->shift[b][k] = rate > 0.0 ? (held.dcapacity[k] - side * held.drest[k]) / rate : 0.0;
    }
}

/* It has happened. */
static void dp_carry_after(const dp_engine *e, const dp_line *l, double tau) {
    dp_carried *c = DP_CARRIED(e);
    double after[DP_NZ];
    int b, k, n, stops = c->stops || (!c->held && e->hold >= 0);
    if (stops && e->hold >= 0 && dp_carry_loose(e, l, tau)) stops = 0;
    dp_carry_rates(e, l, tau, after);
    for (b = 0; b < c->blocks; ++b)
        for (n = 0; n < DP_NZ; ++n)
            for (k = 0; k < DP_LANES; ++k)
                c->dz[b][n][k] = stops && n == 1 ? -after[n] * c->shift[b][k]
                                                 : c->dz[b][n][k] + (c->before[n] - after[n]) * c->shift[b][k];
}

/* The derivatives of a block of the output that was shown, at sample i, among those of the response. */
static void dp_carry_put(const dp_carried *c, long i) {
    long k;
    for (k = 0; k < c->count; ++k) {
        const double shown = c->shown[k / DP_LANES][k % DP_LANES];
        if (c->single)
            ((float *)c->y)[c->row[k] * c->n + i] = (float)shown;
        else
            ((double *)c->y)[c->row[k] * c->n + i] = shown;
    }
}

/* What the derivatives of the state have become since the last sample; they begin anew. */
static void dp_carry_anew(dp_carried *c, long i) {
    long k, at = i * DP_NZ * c->count;
    int n;
    for (n = 0; n < DP_NZ; ++n) {
        for (k = 0; k < c->count; ++k, ++at) {
            const double moved = c->dz[k / DP_LANES][n][k % DP_LANES];
            if (c->single)
                ((float *)c->along)[at] = (float)moved;
            else
                ((double *)c->along)[at] = moved;
        }
    }
    memcpy(c->dz, c->anew, c->blocks * sizeof *c->dz);
}

/* Derivatives of the output at index `shown` of a motion e with the derivatives of c, under its signs or those given. */
static void dp_carry_output(dp_carried *c, const dp_engine *e, const signed char *given, double u, int shown) {
    const dp_line line = {{u, 0.0, 0.0, 0.0}, e->t};
    double s[DP_NS + 1], slopes[DP_OUTPUT_SLOPES], pushed[DP_OUTPUT_PUSHED][DP_LANES], by[DP_NY * DP_NS + 1];
    dp_engine under;
    int b, j, k, held;
    if (dp_output_is_state[shown]) {
        memset(pushed, 0, sizeof pushed);
        for (b = 0; b < c->blocks; ++b) {
            dp_output_along(slopes, pushed, (const double(*)[DP_LANES])c->dz[b], shown, c->shown[b]);
        }
        return;
    }
    if (given) {
        under = *e;
        dp_take_signs(&under, given);
        e = &under;
    }
    dp_signs(e, &line, s);
    if (DP_SURFACES_USE_FORCE) dp_after_jump(e, &line, s);
    held = dp_carry_held(e, &line, 0.0);
    dp_output_slopes(e->z, e->t, u, e->p, s, slopes);
    if (held) dp_output_by_signs(e->z, e->t, u, e->p, s, by);
    for (b = 0; b < c->blocks; ++b) {
        dp_output_pushes(slopes, c->which[b], pushed);
        dp_output_along(slopes, pushed, (const double(*)[DP_LANES])c->dz[b], shown, c->shown[b]);
        if (held) {
            dp_balance w;
            dp_carry_balance(e, &line, 0.0, e->z, (const double(*)[DP_LANES])c->dz[b], c->which[b], &w);
            for (j = 0; j < DP_NS && fabs(w.rest) <= w.capacity; ++j) /* beyond, after a jump of the force, each is one */
                for (k = 0; w.joined[j] && k < DP_LANES; ++k) c->shown[b][k] += by[shown + DP_NY * j] * w.dshare[k];
        }
    }
}

/* The same at sample i, put where it belongs. */
static void dp_carry_shown(const dp_engine *e, const signed char *given, double u, int shown, long i) {
    dp_carried *c = DP_CARRIED(e);
    if (c->along) dp_carry_anew(c, i);
    dp_carry_output(c, e, given, u, shown);
    dp_carry_put(c, i);
}

/* (count) derivatives of the output of the motion as it was at the sample before, under other signs. */
static void dp_carry_beside(const dp_engine *e, const dp_engine *last, const signed char *given, double u, int shown,
                            double *out) {
    dp_carried c = *DP_CARRIED(e);
    long k;
    c.dz = c.last;
    dp_carry_output(&c, last, given, u, shown);
    for (k = 0; k < c.count; ++k) out[k] = c.shown[k / DP_LANES][k % DP_LANES];
}

/* The sample before is now this one. */
static void dp_carry_on(const dp_engine *e) {
    const dp_carried *c = DP_CARRIED(e);
    memcpy(c->last, c->dz, c->blocks * sizeof *c->dz);
}

/* The state is about to be moved by the gain times what was measured at sample i beyond the output. */
static void dp_carry_correction(const dp_engine *e, const double *gain, double u, long i) {
    dp_carried *c = DP_CARRIED(e);
    const dp_line line = {{u, 0.0, 0.0, 0.0}, e->t};
    const int moved = dp_carry_held(e, &line, 0.0) ? 1 : DP_NZ;
    const double time = i * c->dt;
    int b, k, n;
    for (b = 0; b < c->blocks; ++b)
        for (n = 0; n < moved; ++n)
            for (k = 0; k < DP_LANES; ++k)
                c->dz[b][n][k] += gain[n] * (c->sensed[2 * b][k] + c->sensed[2 * b + 1][k] * time - c->shown[b][k]);
}
