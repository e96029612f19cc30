/* The estimator of brake-cal, see bte.h. What takes in a block is written from equations.py of
 * calib/estimation; the rest follows step.py, readout.py, known.py, reasons.py and online.py there.
 */
#include "bte.h"

#include <math.h>
#include <string.h>

#define R(x) ((bte_real)(x))
#define MATH(name) $function
enum { TERMS = $terms, LARGEST = $largest }; /* of the series; of what exp gives a number for */

static const bte_real GRAVITY = R(9.80665), Z95 = R(1.96), LN2_HIGH = R(0.693145751953125),
                      LN2_LOW = R(1.42860682030941723e-6);

/* Sums of a block, SI; rear less front by wheel: float32 has few digits. Drive is of both axles. */
enum { PRESSURE, Z, FRONT, APART, DRIVE };

static bte_real largest(bte_real a, bte_real b) { return a > b ? a : b; }
static bte_real smallest(bte_real a, bte_real b) { return a < b ? a : b; }
static bte_real clip(bte_real x, bte_real a, bte_real b) { return smallest(largest(x, a), b); }
static bte_real square(bte_real x) { return x * x; }

/* Own exp and ln, by their series: those of C libraries differ in the last digits. */
static bte_real exponential(bte_real x) {
    const bte_real held = clip(x, -R(LARGEST), R(LARGEST)), turns = held / (LN2_HIGH + LN2_LOW);
    const int k = (int)(turns + (turns < R(0.0) ? R(-0.5) : R(0.5)));
    const bte_real rest = (held - (bte_real)k * LN2_HIGH) - (bte_real)k * LN2_LOW;
    bte_real sum = R(1.0);
    for (int n = TERMS; n > 0; n--) {
        sum = R(1.0) + sum * rest / (bte_real)n;
    }
    return MATH(ldexp)(sum, k);
}

static bte_real logarithm(bte_real x) {
    int k = 0;
    bte_real m = MATH(frexp)(x, &k), sum = R(0.0);
    if (m <= R(0.70710678118654755)) {
        m = R(2.0) * m;
        k = k - 1;
    }
    const bte_real f = (m - R(1.0)) / (m + R(1.0)), f2 = f * f;
    for (int n = 2 * TERMS - 7; n > 0; n -= 2) { /* needs fewer */
        sum = R(1.0) / (bte_real)n + sum * f2;
    }
    return (bte_real)k * LN2_HIGH + ((bte_real)k * LN2_LOW + R(2.0) * f * sum);
}

/* A median with its bounds `by` higher, these farther away by `more`, added as squares. */
static void widen(bte_real x[BTE_BOUNDS], bte_real by, bte_real more_lower, bte_real more_upper) {
    const bte_real below = x[BTE_LOWER] - x[BTE_MEDIAN], above = x[BTE_UPPER] - x[BTE_MEDIAN];
    x[BTE_MEDIAN] += by;
    x[BTE_LOWER] = x[BTE_MEDIAN] - MATH(sqrt)(square(below) + square(more_lower));
    x[BTE_UPPER] = x[BTE_MEDIAN] + MATH(sqrt)(square(above) + square(more_upper));
}

#ifndef BTE_FIND /* there is no other search; the last point has `along` 1 in the last cell */
static bte_place find(const bte_axis *axis, bte_real x) {
    bte_place place = {0, R(0.0)};
    uint16_t high = (uint16_t)(axis->count - 1U);
    while (place.at + 1U < high) {
        const uint16_t middle = (uint16_t)((place.at + high) / 2U);
        if (axis->x[middle] <= x) {
            place.at = middle;
        } else {
            high = middle;
        }
    }
    const bte_real low = axis->x[place.at];
    place.along = clip((x - low) / (axis->x[place.at + 1U] - low), R(0.0), R(1.0));
    return place;
}
#define BTE_FIND find
#endif

/* All columns of a map at a place. */
static void look_up(const bte_map *map, const bte_real at[], bte_real out[BTE_BOUNDS]) {
    unsigned corners = 1U, cell[8] = {0};
    bte_real weight[8];
    weight[0] = R(1.0);
    for (unsigned a = 0; a < map->axes; a++) { /* parts what the axes before it have in two */
        const bte_place place = BTE_FIND(&map->axis[a], at[a]);
        for (unsigned i = 0; i < corners; i++) {
            cell[i] = cell[i] * map->axis[a].count + place.at;
            cell[corners + i] = cell[i] + 1U;
            weight[corners + i] = weight[i] * place.along;
            weight[i] *= R(1.0) - place.along;
        }
        corners *= 2U;
    }
    for (unsigned c = 0; c < map->columns; c++) {
        out[c] = R(0.0);
        for (unsigned i = 0; i < corners; i++) {
            out[c] += weight[i] * (bte_real)map->cells[c][cell[i]];
        }
        out[c] *= map->step[c];
    }
}

$equations

/* Zeros, from blocks that lie far enough before a bite. */
static void roll(bte_state *s, const bte_block *x, bool counts) {
    const bte_car *c = s->car;
    const bte_real dt = c->block, most = square(c->zero);
    bte_block *oldest = &s->waiting[s->waits % c->waiting];
    s->demand.variance = smallest(s->demand.variance + square(c->q_bias) * dt, most);
    s->eta_less_1.variance = smallest(s->eta_less_1.variance + square(c->q_radius) * dt, most);
    if (x->pressure <= c->bite && s->waits >= c->waiting) {
        const bte_real wheels = c->noise_rim / oldest->rim;
        update_zero(&s->demand, oldest->demand, (square(c->noise_z) + R(1e-8)) / dt);
        update_zero(&s->eta_less_1, oldest->eta_less_1, R(2.0) * square(wheels) / dt);
    }
    if (counts && !s->driven && x->pressure < c->untouched && MATH(fabs)(x->z) < c->steady) {
        *oldest = *x;
        s->waits++;
    } else {
        s->waits = 0;
    }
}

/* ln of the ratio with its bounds, wider by the errors of where the map is read. */
static void read_ratio(const bte_car *c, const bte_real at[BTE_MAP_AXES],
                       const bte_real error[BTE_MAP_AXES], bte_real out[BTE_BOUNDS]) {
    const bte_axis *shifts = &c->pads.axis[BTE_SHIFT];
    const uint16_t cell = BTE_FIND(shifts, at[BTE_SHIFT]).at;
    const bte_real most[] = {R(0.0), shifts->x[cell + 1U] - shifts->x[cell], R(1.0)};
    look_up(&c->pads, at, out);
    for (unsigned axis = BTE_SHIFT; axis < BTE_MAP_AXES; axis++) {
        const bte_real step = smallest(error[axis], most[axis]);
        bte_real place[] = {at[BTE_Z], at[BTE_SHIFT], at[BTE_SLIP]};
        bte_real low[BTE_BOUNDS], high[BTE_BOUNDS];
        place[axis] = at[axis] - step;
        look_up(&c->pads, place, low);
        place[axis] = at[axis] + step;
        look_up(&c->pads, place, high);
        const bte_real by_one = (high[BTE_MEDIAN] - low[BTE_MEDIAN]) / step;
        const bte_real more = R(0.5) * Z95 * error[axis] * by_one;
        widen(out, R(0.0), more, more);
    }
}

static void blend(bte_real x[BTE_BOUNDS], const bte_real y[BTE_BOUNDS], bte_real share) {
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        x[b] = (R(1.0) - share) * x[b] + share * y[b];
    }
}

/* The best informed ratio so far. */
static void keep_best(bte_state *s, const bte_real now[BTE_BOUNDS], bte_real pads, bool is_new,
                      bool adds, bte_real best[BTE_BOUNDS]) {
    const bte_car *c = s->car;
    s->age += c->block;
    const bte_real then = Z95 * MATH(sqrt)(aged(c, s, pads));
    (void)memcpy(best, s->kept, sizeof s->kept);
    widen(best, R(0.0), then, then);
    const bte_real known = best[BTE_UPPER] - best[BTE_LOWER];
    const bte_real of_new = share_of(c, now[BTE_UPPER] - now[BTE_LOWER], known);
    const bte_real share = is_new ? R(1.0) : adds ? of_new : R(0.0);
    blend(s->kept, now, share);
    const bte_real wider = Z95 * MATH(sqrt)(renewed(c, s, pads, share));
    (void)memcpy(best, s->kept, sizeof s->kept);
    widen(best, R(0.0), wider, wider);
}

/* ln of the pads by level and ratio; distances to their bounds add up as squares. */
static void part_pads(const bte_car *c, bte_real ln[BTE_BRAKE_TORQUE_F][BTE_BOUNDS]) {
    bte_real front[BTE_BOUNDS], rear[BTE_BOUNDS];
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        const bte_real ratio = ln[BTE_RATIO][b];
        rear[b] = -logarithm(c->share * exponential(ratio) + (R(1.0) - c->share));
        front[b] = ratio + rear[b];
        ln[BTE_PAD_FRICTION_F][b] = ln[BTE_LEVEL][b];
        ln[BTE_PAD_FRICTION_R][b] = ln[BTE_LEVEL][b];
    }
    widen(ln[BTE_PAD_FRICTION_F], front[0], front[0] - front[1], front[0] - front[2]);
    widen(ln[BTE_PAD_FRICTION_R], rear[0], rear[0] - rear[2], rear[0] - rear[1]);
}

static void take(bte_state *s, const bte_block *x) {
    const bte_car *c = s->car;
    const bool counts = x->rim > c->moving && s->worst == BTE_VALID;
    roll(s, x, counts);
    step_filters(c, s, x, counts);
    const bte_block_state seen = block_state(c, s, x, counts);
    const bool is_new = seen.blocks == R(0.0);
    const bte_real z = is_new ? c->usual_z : seen.z, shifted = seen.shift / z;
    bte_real at[BTE_MAP_AXES] = {z, shifted, R(0.0)};
    bte_real by_map[BTE_BOUNDS], ln[BTE_BRAKE_TORQUE_F][BTE_BOUNDS], *level = ln[BTE_LEVEL];
    look_up(&c->slip, at, by_map);
    look_up(&c->level, at, level);
    const bte_slip_evidence w = weighed(c, &seen, z, by_map[0], by_map[1]);
    const bte_real wider = Z95 * MATH(sqrt)(w.noise + w.accelerometer);
    widen(level, logarithm(w.pads * w.scaled), wider, wider);
    /* ratio */
    const bte_axis *shifts = &c->pads.axis[BTE_SHIFT];
    const bool of_map = shifted >= shifts->x[0] && shifted <= shifts->x[shifts->count - 1U];
    bte_real now[BTE_BOUNDS], prior[BTE_BOUNDS];
    at[BTE_SLIP] = w.slip;
    const bte_real error[BTE_MAP_AXES] = {R(0.0), eta_error(c, &seen, z) / z, w.slip_sigma};
    read_ratio(c, at, error, now);
    look_up(&c->before, at, prior);
    bte_real unread = (now[BTE_UPPER] - now[BTE_LOWER]) / (prior[BTE_UPPER] - prior[BTE_LOWER]);
    const bool told = !is_new && of_map && z >= c->least_z;
    const bte_real read = told ? share_of(c, unread, R(1.0)) : R(0.0);
    blend(now, prior, R(1.0) - read);
    unread = R(1.0) + read * (unread - R(1.0));
    widen(now, square(unread) * (c->ramp_ratio - prior[BTE_MEDIAN]), R(0.0), R(0.0));
    keep_best(s, now, w.pads, is_new, counts && x->pressure > c->bite, ln[BTE_RATIO]);
    part_pads(c, ln);
    for (unsigned i = 0; i < BTE_BRAKE_TORQUE_F; i++) { /* it starts with those of the file */
        for (unsigned b = 0; b < BTE_BOUNDS; b++) {
            s->told[i][b] = c->start.told[i][BTE_MEDIAN] * exponential(ln[i][b]);
        }
    }
    s->reason = (bte_reason)reason_of(c, x, &seen, s->told[BTE_LEVEL][BTE_MEDIAN], of_map);
}

void bte_told(const bte_state *s, bte_real p_mc, bte_real out[BTE_ANSWERS][BTE_BOUNDS]) {
    const bte_real *level = s->told[BTE_LEVEL], *gain = s->car->torque_gain;
    (void)memcpy(out, s->told, sizeof s->told);
    for (unsigned b = 0; b < BTE_BOUNDS; b++) { /* the median first */
        for (unsigned a = 0; a < BTE_AXLES; a++) {
            const bte_real clamp = gain[a] * largest(p_mc, R(0.0));
            out[BTE_BRAKE_TORQUE_F + a][b] = clamp * s->told[BTE_PAD_FRICTION_F + a][b];
        }
        const bte_real axles = out[BTE_BRAKE_TORQUE_F][0] + out[BTE_BRAKE_TORQUE_R][0];
        out[BTE_BRAKE_TORQUE_SUM][b] = R(2.0) * axles * (level[b] / level[BTE_MEDIAN]);
    }
}

/* Slip of an axle by its force and load. */
static bte_real slip_at(const bte_car *c, bte_real force, bte_real load) {
    const bte_place at = BTE_FIND(&c->tyre, force / largest(load, R(0.1) * c->weight));
    const bte_real low = c->tyre_slip[at.at], high = c->tyre_slip[at.at + 1U];
    return low + at.along * (high - low);
}

/* Take in a sample: the last good reading counts while one is out of its range, or jumps. Whether
 * all sensors work. */
static bool take_sample(bte_state *s, const bte_real x[BTE_INPUTS]) {
    const bte_car *c = s->car;
    const bool same = s->started && x[BTE_A_X] == s->last[BTE_A_X];
    bool fine = true;
    for (unsigned i = 0; i < BTE_INPUTS; i++) {
        const bool inside = x[i] >= c->low[i] && x[i] <= c->high[i];
        const bool taken = inside && !(s->started && MATH(fabs)(x[i] - s->raw[i]) > c->change[i]);
        s->raw[i] = inside ? x[i] : s->raw[i];
        s->last[i] = taken ? x[i] : s->last[i];
        fine = fine && taken;
    }
    /* an accelerometer that does not move while the pressure does is frozen */
    s->held = same ? s->held + c->sample_time : R(0.0);
    s->p_held = same ? s->p_held : s->last[BTE_P_MC];
    return fine && !(s->held > c->held_time - R(0.5) * c->sample_time
                     && MATH(fabs)(s->last[BTE_P_MC] - s->p_held) > c->held_pressure
                     && c->radius[BTE_FRONT] * s->last[BTE_OMEGA_FL] > c->moving);
}

/* Whether the car is steered, corners, or a wheel locks, or just has. */
static bte_reason disturbance(bte_state *s, bool fine) {
    const bte_car *c = s->car;
    const bte_real *x = s->last, *omega = &x[BTE_OMEGA_FL];
    bte_real fastest = R(0.0), slowest = R(0.0);
    for (unsigned w = 0; w < BTE_WHEELS; w++) {
        bte_real *b = s->before[w];
        const bte_real last = s->started ? b[1] : omega[w], first = s->started ? b[0] : last;
        const bte_real middle = clip(omega[w], smallest(first, last), largest(first, last));
        b[0] = last;
        b[1] = omega[w];
        fastest = w == 0U ? middle : largest(fastest, middle);
        slowest = w == 0U ? middle : smallest(slowest, middle);
    }
    const bte_real mean = R(0.5) * (x[BTE_OMEGA_RL] + x[BTE_OMEGA_RR]);
    const bte_real speed = c->radius[BTE_REAR] * mean, z = -x[BTE_A_X] / GRAVITY;
    s->fastest = largest(fastest, s->fastest - c->slows * c->sample_time);
    const bool locks = s->fastest - slowest > c->lock * largest(s->fastest, R(1.0))
                       && s->fastest > c->turning;
    s->since_lock = locks ? R(0.0) : s->since_lock + c->sample_time;
    const bte_real apart = (x[BTE_OMEGA_RR] - x[BTE_OMEGA_RL]) / largest(mean, R(1.0));
    const bte_real slip = largest(slip_at(c, z * c->weight, c->weight), R(0.0));
    const bte_real leaned = R(4.0) * slip * c->cg_height / (GRAVITY * c->track_width);
    const bte_real turned = apart / (c->track_width / square(largest(speed, c->moving)) + leaned);
    s->lateral = s->started ? s->lateral + c->lateral_part * (turned - s->lateral) : turned;
    return !fine                                                    ? BTE_FAULT
           : s->since_lock <= c->recover + R(0.5) * c->sample_time  ? BTE_LOCKED
           : !(MATH(fabs)(s->lateral) < c->lateral)                 ? BTE_CORNERS
           : !(MATH(fabs)(x[BTE_STEERING]) < c->steering)           ? BTE_TURNED
                                                                    : BTE_VALID;
}

/* A block from the sums: the force balance (1), (5) to (7), drag and rolling resistance known. */
static void block_ends(bte_state *s) {
    const bte_car *c = s->car;
    bte_real mean[BTE_SIGNALS], load[BTE_AXLES], other[BTE_AXLES], driven[BTE_AXLES];
    for (unsigned i = 0; i < BTE_SIGNALS; i++) {
        mean[i] = s->sum[i] / (bte_real)c->samples;
    }
    const bte_real p = mean[PRESSURE], z = mean[Z];
    const bte_real omega[BTE_AXLES] = {mean[FRONT], mean[FRONT] + mean[APART]};
    const bte_real speed = c->radius[BTE_REAR] * omega[BTE_REAR];
    const bte_real body = c->drag * square(speed);
    const bte_real grown = R(1.0) + c->rolling_growth * (square(speed / R(20.0)) - R(1.0));
    const bool held = s->faulty || s->worst == BTE_FAULT; /* a reading: nothing is known of spins */
    bte_real demanded = c->weight * z - body;
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        const bte_real spin = held            ? -GRAVITY * z / c->radius[a]
                              : s->block_full ? (omega[a] - s->omega[a]) / c->block
                                              : R(0.0);
        s->omega[a] = omega[a];
        load[a] = c->weight * (c->load[a] + c->height[a] * z);
        other[a] = c->rolling * grown * load[a] - mean[DRIVE + a] / c->radius[a];
        demanded -= other[a] + c->turning_mass[a] * c->radius[a] * spin;
    }
    s->block_full = true;
    s->faulty = s->worst == BTE_FAULT;
    const bte_real z_alone = demanded / c->rolls;
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        const bte_real tyre = c->ramp_share[a] * demanded
                              - c->turning_mass[a] * GRAVITY * z_alone;
        const bte_real alone = c->weight * (c->load[a] + c->height[a] * z_alone);
        load[a] += c->weight * c->drag_lift[a] * body;
        driven[a] = slip_at(c, tyre + other[a], load[a]) - slip_at(c, tyre, alone);
    }
    const bte_real eta_less_1 = mean[FRONT] > R(0.0) ? mean[APART] / mean[FRONT] : R(0.0);
    const bte_real left = eta_less_1 + driven[BTE_REAR] - driven[BTE_FRONT] * (R(1.0) + eta_less_1);
    const bte_real rim = c->radius[BTE_FRONT] * omega[BTE_FRONT] / (R(1.0) - driven[BTE_FRONT]);
    const bte_block block = {demanded / c->weight, c->force / c->weight * p, p, z,
                             left / (R(1.0) - driven[BTE_REAR]), largest(rim, c->slowest),
                             load[BTE_REAR] / c->weight, (bte_real)s->worst};
    take(s, &block);
}

void bte_init(bte_state *s, const bte_car *car) {
    *s = car->start;
    s->car = car;
}

bool bte_exchange(bte_state *s, const bte_car *car) {
    bool rests = true;
    for (unsigned w = 0; w < BTE_WHEELS; w++) {
        rests = rests && MATH(fabs)(s->last[BTE_OMEGA_FL + w]) < s->car->rests;
    }
    if (rests) {
        bte_init(s, car);
    }
    return rests;
}

bte_reason bte_step(bte_state *s, const bte_real x[BTE_INPUTS],
                    bte_real out[BTE_ANSWERS][BTE_BOUNDS]) {
    const bool fine = take_sample(s, x), begins = s->count == 0U;
    const bte_reason disturbed = disturbance(s, fine);
    const bte_real *last = s->last;
    s->started = true;
    s->worst = begins || disturbed > s->worst ? disturbed : s->worst;
    s->driven = last[BTE_DRIVEN] > R(0.5) || (!begins && s->driven);
    const bte_real front = last[BTE_OMEGA_FL] + last[BTE_OMEGA_FR];
    const bte_real apart = (last[BTE_OMEGA_RL] - last[BTE_OMEGA_FL])
                           + (last[BTE_OMEGA_RR] - last[BTE_OMEGA_FR]);
    const bte_real signal[BTE_SIGNALS] = {last[BTE_P_MC], -last[BTE_A_X] / GRAVITY,
                                          R(0.5) * front, R(0.5) * apart,
                                          last[BTE_T_DRIVE_F], last[BTE_T_DRIVE_R]};
    for (unsigned i = 0; i < BTE_SIGNALS; i++) {
        s->sum[i] = begins ? signal[i] : s->sum[i] + signal[i];
    }
    s->count++;
    if (s->count >= s->car->samples) {
        s->count = 0;
        block_ends(s);
    }
    bte_told(s, last[BTE_P_MC], out);
    return fine ? s->reason : BTE_FAULT;
}
