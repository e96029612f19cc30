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

static bte_real largest(bte_real a, bte_real b) { return a > b ? a : b; }
static bte_real smallest(bte_real a, bte_real b) { return a < b ? a : b; }
static bte_real clip(bte_real x, bte_real a, bte_real b) { return smallest(largest(x, a), b); }
static bte_real square(bte_real x) { return x * x; }

/* Own exp and ln, by their series: those of C libraries differ in the last digits. */
static bte_real exponential(bte_real x) {
    const bte_real clipped = clip(x, -R(LARGEST), R(LARGEST));
    const bte_real turns = clipped / (LN2_HIGH + LN2_LOW);
    const int k = (int)(turns + (turns < R(0.0) ? R(-0.5) : R(0.5)));
    const bte_real residual = (clipped - (bte_real)k * LN2_HIGH) - (bte_real)k * LN2_LOW;
    bte_real sum = R(1.0);
    for (int n = TERMS; n > 0; n--) {
        sum = R(1.0) + sum * residual / (bte_real)n;
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
static void widen(bte_interval *x, bte_real by, bte_real more_lower, bte_real more_upper) {
    const bte_real below = x->lower - x->median, above = x->upper - x->median;
    x->median += by;
    x->lower = x->median - MATH(sqrt)(square(below) + square(more_lower));
    x->upper = x->median + MATH(sqrt)(square(above) + square(more_upper));
}

#ifndef BTE_FIND /* there is no other search; the last point has `along` 1 in the last cell */
static bte_place find(const bte_axis *axis, bte_real x) {
    bte_place place = {0, R(0.0)};
    uint16_t high = (uint16_t)(axis->count - 1U);
    while (place.cell + 1U < high) {
        const uint16_t middle = (uint16_t)((place.cell + high) / 2U);
        if (axis->x[middle] <= x) {
            place.cell = middle;
        } else {
            high = middle;
        }
    }
    const bte_real low = axis->x[place.cell];
    place.along = clip((x - low) / (axis->x[place.cell + 1U] - low), R(0.0), R(1.0));
    return place;
}
#define BTE_FIND find
#endif

/* The first columns of a map at a place. */
static void look_up(const bte_map *map, const bte_real point[], unsigned columns, bte_real out[]) {
    unsigned corners = 1U, cell[8] = {0};
    bte_real weight[8];
    weight[0] = R(1.0);
    for (unsigned a = 0; a < map->axes; a++) { /* parts what the axes before it have in two */
        const bte_place place = BTE_FIND(&map->axis[a], point[a]);
        for (unsigned i = 0; i < corners; i++) {
            cell[i] = cell[i] * map->axis[a].count + place.cell;
            cell[corners + i] = cell[i] + 1U;
            weight[corners + i] = weight[i] * place.along;
            weight[i] *= R(1.0) - place.along;
        }
        corners *= 2U;
    }
    for (unsigned c = 0; c < columns; c++) {
        out[c] = R(0.0);
        for (unsigned i = 0; i < corners; i++) {
            out[c] += weight[i] * (bte_real)map->cells[c][cell[i]];
        }
        out[c] *= map->step[c];
    }
}

static bte_interval interval_at(const bte_map *map, const bte_real point[]) {
    bte_real x[BTE_COLUMNS];
    look_up(map, point, BTE_COLUMNS, x);
    const bte_interval read = {x[0], x[1], x[2]};
    return read;
}

$equations

/* Zeros, from blocks that lie far enough before a bite. */
static void roll(bte_state *state, const bte_block *x, bool counts) {
    const bte_car *car = state->car;
    BTE_CAL bte_numbers *c = car->numbers;
    bte_filters *s = &state->filters;
    const bte_real dt = c->block, most = square(c->zero);
    bte_rolling *oldest = &state->waiting[state->waits % car->waiting];
    s->demand.variance = smallest(s->demand.variance + square(c->q_bias) * dt, most);
    s->eta_less_1.variance = smallest(s->eta_less_1.variance + square(c->q_radius) * dt, most);
    if (x->pressure <= c->bite && state->waits >= car->waiting) {
        const bte_real wheels = c->noise_rim / oldest->rim;
        if (zero_fits(c, s, oldest->demand, oldest->eta_less_1)) {
            update_zero(&s->demand, oldest->demand, (square(c->noise_z) + R(1e-8)) / dt);
            update_zero(&s->eta_less_1, oldest->eta_less_1, R(2.0) * square(wheels) / dt);
        }
    }
    if (counts && !state->driven && x->pressure < c->untouched && MATH(fabs)(x->z) < c->steady) {
        oldest->demand = x->demand;
        oldest->eta_less_1 = x->eta_less_1;
        oldest->rim = x->rim;
        state->waits++;
    } else {
        state->waits = 0;
    }
}

/* ln of the ratio with its bounds, wider by the errors of where the map is read. */
static bte_interval read_ratio(const bte_car *car, const bte_real point[BTE_MAP_AXES],
                               const bte_real error[BTE_MAP_AXES]) {
    const bte_axis *shifts = &car->pads.axis[BTE_SHIFT];
    const uint16_t cell = BTE_FIND(shifts, point[BTE_SHIFT]).cell;
    const bte_real most[] = {R(0.0), shifts->x[cell + 1U] - shifts->x[cell], R(1.0)};
    bte_interval ratio = interval_at(&car->pads, point);
    for (unsigned axis = BTE_SHIFT; axis < BTE_MAP_AXES; axis++) {
        const bte_real step = smallest(error[axis], most[axis]);
        bte_real place[] = {point[BTE_Z], point[BTE_SHIFT], point[BTE_SLIP]};
        place[axis] = point[axis] - step;
        bte_real low, high;
        look_up(&car->pads, place, 1U, &low);
        place[axis] = point[axis] + step;
        look_up(&car->pads, place, 1U, &high);
        const bte_real by_one = (high - low) / step;
        const bte_real more = R(0.5) * Z95 * error[axis] * by_one;
        widen(&ratio, R(0.0), more, more);
    }
    return ratio;
}

static void blend(bte_interval *x, const bte_interval *y, bte_real share) {
    x->median = (R(1.0) - share) * x->median + share * y->median;
    x->lower = (R(1.0) - share) * x->lower + share * y->lower;
    x->upper = (R(1.0) - share) * x->upper + share * y->upper;
}

/* The best informed ratio so far. */
static bte_interval best_ratio(bte_state *state, const bte_interval *now, bte_real level,
                               bool is_new, bool adds) {
    BTE_CAL bte_numbers *c = state->car->numbers;
    bte_filters *s = &state->filters;
    s->age += c->block;
    const bte_real then = Z95 * MATH(sqrt)(held_variance(c, s, level));
    bte_interval best = state->ratio;
    widen(&best, R(0.0), then, then);
    const bte_real of_new = share_of(c, now->upper - now->lower, best.upper - best.lower);
    const bte_real share = is_new ? R(1.0) : adds ? of_new : R(0.0);
    blend(&state->ratio, now, share);
    const bte_real wider = Z95 * MATH(sqrt)(reset_held(c, s, level, share));
    best = state->ratio;
    widen(&best, R(0.0), wider, wider);
    return best;
}

static bte_interval scaled(bte_real by, const bte_interval *ln) {
    const bte_interval x = {by * exponential(ln->median), by * exponential(ln->lower),
                            by * exponential(ln->upper)};
    return x;
}

/* ln of the rear pads over those of the level, by ln of the ratio. */
static bte_real rear_of(BTE_CAL bte_numbers *c, bte_real ratio) {
    return -logarithm(c->share * exponential(ratio) + (R(1.0) - c->share));
}

/* Pads by ln of level and ratio; distances to their bounds add up as squares. */
static void answer_pads(bte_state *s, const bte_interval *level, const bte_interval *ratio) {
    BTE_CAL bte_numbers *c = s->car->numbers;
    const bte_interval rear = {rear_of(c, ratio->median), rear_of(c, ratio->lower),
                               rear_of(c, ratio->upper)};
    const bte_interval front = {ratio->median + rear.median, ratio->lower + rear.lower,
                                ratio->upper + rear.upper};
    bte_interval of_front = *level, of_rear = *level;
    widen(&of_front, front.median, front.median - front.lower, front.median - front.upper);
    widen(&of_rear, rear.median, rear.median - rear.upper, rear.median - rear.lower);
    const bte_real friction_f = c->pad_friction[BTE_FRONT], friction_r = c->pad_friction[BTE_REAR];
    s->answers.pad_level = scaled(R(1.0), level);
    s->answers.pad_ratio = scaled(friction_f / friction_r, ratio);
    s->answers.pad_friction_f = scaled(friction_f, &of_front);
    s->answers.pad_friction_r = scaled(friction_r, &of_rear);
}

static bte_interval times(bte_real by, const bte_interval *x) {
    const bte_interval y = {by * x->median, by * x->lower, by * x->upper};
    return y;
}

/* Torques by the pads of the last block and the pressure of now. */
static void answer_torques(bte_state *s) {
    BTE_CAL bte_numbers *c = s->car->numbers;
    bte_answers *y = &s->answers;
    const bte_real p_mc = largest(s->last.p_mc, R(0.0));
    y->brake_torque_fl = times(c->torque_gain[BTE_FRONT] * p_mc, &y->pad_friction_f);
    y->brake_torque_fr = y->brake_torque_fl;
    y->brake_torque_rl = times(c->torque_gain[BTE_REAR] * p_mc, &y->pad_friction_r);
    y->brake_torque_rr = y->brake_torque_rl;
    const bte_real sum = R(2.0) * (y->brake_torque_fl.median + y->brake_torque_rl.median);
    y->brake_torque_sum = times(sum / y->pad_level.median, &y->pad_level);
}

/* A sum with one more word of 32 bits, and with one more number: FNV-1a by such words. */
static uint32_t with_word(uint32_t sum, uint64_t word) {
    return (uint32_t)(((sum ^ (word & 0xFFFFFFFFU)) * 16777619U) & 0xFFFFFFFFU);
}

static uint32_t mixed(uint32_t sum, bte_real x) {
    uint${floating}_t bits;
    (void)memcpy(&bits, &x, sizeof bits);
    const uint64_t wide = bits;
    return with_word(with_word(sum, wide), wide >> 32U);
}

/* The sum over what lasts. */
static uint32_t seal_of(const bte_state *s) {
    const bte_filters *f = &s->filters;
    const bte_real lasts[] = {f->demand.value,        f->demand.variance, f->eta_less_1.value,
                              f->eta_less_1.variance, f->level.lag,       f->level.var_lag};
    uint32_t sum = BTE_LAYOUT ^ (uint32_t)sizeof *s;
    for (unsigned i = 0; i < sizeof lasts / sizeof lasts[0]; i++) {
        sum = mixed(sum, lasts[i]);
    }
    return sum;
}

static void take(bte_state *state, const bte_block *x) {
    const bte_car *car = state->car;
    BTE_CAL bte_numbers *c = car->numbers;
    const bool usual = x->rim > c->moving && state->worst == BTE_VALID;
    brake_line_lag(c, &state->filters, x->nominal);
    const bool fits = motor_fits(c, &state->filters, x, usual), counts = usual && fits;
    roll(state, x, counts);
    step_filters(c, &state->filters, x, counts);
    const bte_block_state estimate = block_state(c, &state->filters, x, counts);
    const bool is_new = estimate.blocks == R(0.0);
    const bte_real z = is_new ? c->usual_z : estimate.z, shifted = estimate.shift / z;
    bte_real point[BTE_MAP_AXES] = {z, shifted, R(0.0)}, by_map[BTE_COLUMNS];
    look_up(&car->slip, point, 2U, by_map);
    bte_interval level = interval_at(&car->level, point);
    const bte_slip_evidence w = slip_evidence(c, &estimate, z, by_map[0], by_map[1]);
    const bte_real wider = Z95 * MATH(sqrt)(w.noise + w.accelerometer);
    widen(&level, logarithm(w.pads * w.scaled), wider, wider);
    /* ratio */
    const bte_axis *shifts = &car->pads.axis[BTE_SHIFT];
    const bool of_map = shifted >= shifts->x[0] && shifted <= shifts->x[shifts->count - 1U];
    point[BTE_SLIP] = w.slip;
    const bte_real error[BTE_MAP_AXES] = {R(0.0), eta_error(c, &estimate, z) / z, w.slip_sigma};
    bte_interval now = read_ratio(car, point, error);
    const bte_interval prior = interval_at(&car->prior, point);
    const bte_real unread = (now.upper - now.lower) / (prior.upper - prior.lower);
    const bool reads = !is_new && of_map && z >= c->least_z;
    const bte_real read = reads ? share_of(c, unread, R(1.0)) : R(0.0);
    blend(&now, &prior, R(1.0) - read);
    const bte_real of_prior = R(1.0) + read * (unread - R(1.0));
    widen(&now, square(of_prior) * (c->ramp_ratio - prior.median), R(0.0), R(0.0));
    const bool adds = counts && x->pressure > c->bite;
    const bte_interval ratio = best_ratio(state, &now, w.pads, is_new, adds);
    answer_pads(state, &level, &ratio);
    const bte_real median = state->answers.pad_level.median;
    state->checks = (uint16_t)estimate.checks;
    state->block_reason = (bte_reason)reason_of(c, x, &estimate, median, of_map);
    state->seal = seal_of(state);
}

/* Slip of an axle by its force and load. */
static bte_real slip_at(const bte_car *car, bte_real force, bte_real load) {
    const bte_real least = R(0.1) * car->numbers->weight;
    const bte_place place = BTE_FIND(&car->tyre, force / largest(load, least));
    const bte_real low = car->tyre_slip[place.cell], high = car->tyre_slip[place.cell + 1U];
    return low + place.along * (high - low);
}

/* Take in a sample: the last good reading counts while one is out of its range, or jumps. Bits of
 * the sensors that fail. */
static uint32_t take_sample(bte_state *s, const bte_inputs *inputs) {
    BTE_CAL bte_numbers *c = s->car->numbers;
    bte_real x[BTE_INPUTS], last[BTE_INPUTS]; /* the same, by number */
    uint32_t failing = 0U;
    (void)memcpy(x, inputs, sizeof x);
    (void)memcpy(last, &s->last, sizeof last);
    for (unsigned i = 0; i < (unsigned)BTE_INPUTS; i++) {
        const bool inside = x[i] >= c->low[i] && x[i] <= c->high[i];
        const bool taken = inside && !(s->started && MATH(fabs)(x[i] - s->raw[i]) > c->change[i]);
        s->raw[i] = inside ? x[i] : s->raw[i];
        last[i] = taken ? x[i] : last[i];
        failing |= taken ? 0U : ((uint32_t)1U << i);
    }
    (void)memcpy(&s->last, last, sizeof last);
    return failing;
}

/* Count what fails, and how often it began to. */
static void diagnose(bte_state *s, uint32_t failing) {
    const uint32_t begins = failing & ~s->diagnosis;
    for (unsigned i = 0; failing != 0U && i < (unsigned)BTE_DIAGNOSES; i++) {
        s->often[i] = (uint16_t)(s->often[i] + ((begins >> i) & 1U));
        s->lasted[i] += (failing >> i) & 1U;
    }
    s->diagnosis = failing;
}

/* Whether the car is steered, corners, a wheel locks or ABS acts, or just has. */
static bte_reason disturbance(bte_state *s, bool fine) {
    BTE_CAL bte_numbers *c = s->car->numbers;
    const bte_inputs *x = &s->last;
    const bte_real omega[BTE_WHEELS] = {x->omega_fl, x->omega_fr, x->omega_rl, x->omega_rr};
    bte_real fastest = s->fastest - c->slows * c->sample_time, slowest = R(1e9);
    for (unsigned w = 0; w < (unsigned)BTE_WHEELS; w++) {
        bte_real *past = s->wheels[w];
        if (!s->started) {
            past[0] = omega[w];
            past[1] = omega[w];
        }
        const bte_real low = smallest(past[0], past[1]), high = largest(past[0], past[1]);
        const bte_real middle = clip(omega[w], low, high);
        past[0] = past[1];
        past[1] = omega[w];
        fastest = largest(fastest, middle);
        slowest = smallest(slowest, middle);
    }
    const bte_real mean = R(0.5) * (x->omega_rl + x->omega_rr);
    const bte_real speed = c->rolling_radius[BTE_REAR] * mean, z = -x->a_x / GRAVITY;
    const bool locks = fastest - slowest > c->lock * largest(fastest, R(1.0))
                       && fastest > c->turning;
    s->fastest = fastest;
    s->since_lock = locks ? R(0.0) : s->since_lock + c->sample_time;
    s->since_abs = x->abs_active > R(0.5) ? R(0.0) : s->since_abs + c->sample_time;
    const bte_real apart = (x->omega_rr - x->omega_rl) / largest(mean, R(1.0));
    const bte_real slip = largest(slip_at(s->car, z * c->weight, c->weight), R(0.0));
    const bte_real leaned = R(4.0) * slip * c->cg_height / (GRAVITY * c->track_width);
    const bte_real turned = apart / (c->track_width / square(largest(speed, c->moving)) + leaned);
    s->lateral = s->started ? s->lateral + c->lateral_part * (turned - s->lateral) : turned;
    const bte_real recent = c->recover + R(0.5) * c->sample_time;
    bte_reason why;
    if (!fine) {
        why = BTE_FAULT;
    } else if (s->since_abs <= recent) {
        why = BTE_ABS;
    } else if (s->since_lock <= recent) {
        why = BTE_LOCKED;
    } else if (!(MATH(fabs)(s->lateral) < c->lateral)) {
        why = BTE_CORNERS;
    } else if (!(MATH(fabs)(x->steering) < c->steering)) {
        why = BTE_TURNED;
    } else {
        why = BTE_VALID;
    }
    return why;
}

/* A block from the sums: the force balance (1), (5) to (7), drag and rolling resistance known. */
static void block_ends(bte_state *s) {
    const bte_car *car = s->car;
    BTE_CAL bte_numbers *c = car->numbers;
    const bte_real n = (bte_real)car->samples;
    const bte_real p = s->sum.p_mc / n, z = s->sum.z / n, front = s->sum.omega_f / n;
    const bte_real apart = s->sum.apart / n, omega[BTE_AXLES] = {front, front + apart};
    const bte_real drive[BTE_AXLES] = {s->sum.drive_f / n, s->sum.drive_r / n};
    bte_real load[BTE_AXLES], other[BTE_AXLES], driven[BTE_AXLES];
    const bte_real speed = c->rolling_radius[BTE_REAR] * omega[BTE_REAR];
    const bte_real body = c->drag * square(speed);
    const bte_real grown = R(1.0) + c->rolling_growth * (square(speed / R(20.0)) - R(1.0));
    const bool is_stale = s->faulty || s->failed; /* nothing is known of spins */
    bte_real demanded = c->weight * z - body;
    for (unsigned a = 0; a < (unsigned)BTE_AXLES; a++) {
        const bte_real radius = c->rolling_radius[a];
        const bte_real spin = is_stale        ? -GRAVITY * z / radius
                              : s->block_full ? (omega[a] - s->omega[a]) / c->block
                                              : R(0.0);
        s->omega[a] = omega[a];
        load[a] = c->weight * (c->load[a] + c->height[a] * z);
        other[a] = c->rolling * grown * load[a] - drive[a] / radius;
        demanded -= other[a] + c->turning_mass[a] * radius * spin;
    }
    s->block_full = true;
    s->faulty = s->failed;
    const bte_real z_alone = demanded / c->rolls;
    for (unsigned a = 0; a < (unsigned)BTE_AXLES; a++) {
        const bte_real tyre = c->ramp_share[a] * demanded
                              - c->turning_mass[a] * GRAVITY * z_alone;
        const bte_real alone = c->weight * (c->load[a] + c->height[a] * z_alone);
        load[a] += c->weight * c->drag_lift[a] * body;
        driven[a] = slip_at(car, tyre + other[a], load[a]) - slip_at(car, tyre, alone);
    }
    const bte_real eta_less_1 = front > R(0.0) ? apart / front : R(0.0);
    const bte_real eta = eta_less_1 + driven[BTE_REAR] - driven[BTE_FRONT] * (R(1.0) + eta_less_1);
    const bte_real rim = c->rolling_radius[BTE_FRONT] * front / (R(1.0) - driven[BTE_FRONT]);
    bte_block block;
    block.demand = demanded / c->weight;
    block.nominal = c->force / c->weight * p;
    block.pressure = p;
    block.z = z;
    block.eta_less_1 = eta / (R(1.0) - driven[BTE_REAR]);
    block.rim = largest(rim, c->slowest);
    block.rear_share = load[BTE_REAR] / c->weight;
    block.disturbed = (bte_real)s->worst;
    block.drive = (drive[BTE_FRONT] / c->rolling_radius[BTE_FRONT]
                   + drive[BTE_REAR] / c->rolling_radius[BTE_REAR])
                  / c->weight;
    take(s, &block);
}

static void begin(bte_state *s, const bte_car *car) {
    BTE_CAL bte_numbers *c = car->numbers;
    const bte_interval any = {R(0.0), logarithm(c->least_level), logarithm(c->most_level)};
    (void)memset(s, 0, sizeof *s);
    s->reason = (uint32_t)BTE_NOT_BRAKED;
    s->block_reason = BTE_NOT_BRAKED;
    s->layout = BTE_LAYOUT;
    s->car = car;
$first
    s->since_lock = R(2.0) * c->recover;
    s->since_abs = s->since_lock;
    start(c, &s->filters);
    answer_pads(s, &any, &any);
    s->seal = seal_of(s);
}

static bool is_taken(const bte_car *car) {
    return car->layout == BTE_LAYOUT && car->size == sizeof(bte_car) + sizeof(bte_numbers)
           && car->waiting >= 1U && car->waiting <= 3U;
}

/* Zeros of the sensors and the lag of the brakes last, where a state may take the data. */
static bool begin_again(bte_state *s, const bte_car *car, bool may) {
    const bool taken = may && is_taken(car);
    if (taken) {
        const bte_zero demand = s->filters.demand, eta_less_1 = s->filters.eta_less_1;
        const bte_real lag = s->filters.level.lag, var_lag = s->filters.level.var_lag;
        begin(s, car);
        s->filters.demand = demand;
        s->filters.eta_less_1 = eta_less_1;
        s->filters.level.lag = lag;
        s->filters.level.var_lag = var_lag;
        s->seal = seal_of(s);
    }
    return taken;
}

static uint32_t of_reals(uint32_t sum, BTE_CAL bte_real x[], uint32_t count) {
    uint32_t so_far = sum;
    for (uint32_t i = 0; i < count; i++) {
        so_far = mixed(so_far, x[i]);
    }
    return so_far;
}

static uint32_t of_map(uint32_t sum, const bte_map *map) {
    uint32_t cells = 1U, so_far = sum;
    for (unsigned a = 0; a < map->axes; a++) {
        cells *= map->axis[a].count;
        so_far = of_reals(so_far, map->axis[a].x, map->axis[a].count);
    }
    for (unsigned k = 0; k < map->columns; k++) {
        so_far = mixed(so_far, map->step[k]);
        for (uint32_t i = 0; i < cells; i++) {
            so_far = mixed(so_far, (bte_real)map->cells[k][i]);
        }
    }
    return so_far;
}

static uint32_t checksum(const bte_car *car) {
    BTE_CAL bte_real *numbers = (BTE_CAL bte_real *)car->numbers; /* all of one type */
    uint32_t sum = of_reals(0U, numbers, (uint32_t)(sizeof *car->numbers / sizeof *numbers));
    sum = of_map(of_map(sum, &car->pads), &car->slip);
    sum = of_map(of_map(sum, &car->level), &car->prior);
    return of_reals(of_reals(sum, car->tyre.x, car->tyre.count), car->tyre_slip, car->tyre.count);
}

bte_status bte_init(bte_state *s, const bte_car *car) {
    bte_status status = BTE_REFUSED;
    if (is_taken(car)) {
        begin(s, car);
        status = checksum(car) == car->checksum ? BTE_READY : BTE_CALIBRATED;
    } else {
        (void)memset(s, 0, sizeof *s);
    }
    return status;
}

bool bte_exchange(bte_state *s, const bte_car *car) {
    const bool known = s->layout == BTE_LAYOUT;
    const bte_real rests = known ? s->car->numbers->rests : R(0.0);
    return begin_again(s, car, MATH(fabs)(s->omega[BTE_FRONT]) < rests
                                   && MATH(fabs)(s->omega[BTE_REAR]) < rests);
}

bool bte_resume(bte_state *s, const bte_car *car) {
    return begin_again(s, car, s->layout == BTE_LAYOUT && s->seal == seal_of(s));
}

static bte_reason step(bte_state *s, const bte_inputs *x) {
    const uint32_t failing = take_sample(s, x);
    const bool fine = failing == 0U;
    const bte_reason disturbed = disturbance(s, fine);
    const bte_inputs *last = &s->last;
    bte_sums_of_block *sum = &s->sum;
    s->started = true;
    s->worst = disturbed > s->worst ? disturbed : s->worst;
    s->failed = s->failed || !fine;
    s->driven = s->driven || last->driven > R(0.5);
    sum->p_mc += last->p_mc;
    sum->z += -last->a_x / GRAVITY;
    sum->omega_f += R(0.5) * (last->omega_fl + last->omega_fr);
    sum->apart += R(0.5) * ((last->omega_rl - last->omega_fl) + (last->omega_rr - last->omega_fr));
    sum->drive_f += last->T_drive_f;
    sum->drive_r += last->T_drive_r;
    s->count++;
    if (s->count >= s->car->samples) {
        block_ends(s);
        s->count = 0;
        s->worst = BTE_VALID;
        s->failed = false;
        s->driven = false;
        (void)memset(sum, 0, sizeof *sum);
    }
    diagnose(s, failing | ((uint32_t)s->checks << (unsigned)BTE_INPUTS));
    answer_torques(s);
    return fine ? s->block_reason : BTE_FAULT;
}

bte_reason bte_step(bte_state *s, const bte_inputs *x) {
    const bte_reason reason = s->layout == BTE_LAYOUT ? step(s, x) : BTE_FAULT;
    s->reason = (uint32_t)reason;
    return reason;
}
