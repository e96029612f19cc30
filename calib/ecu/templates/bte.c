/* The estimator of brake-cal, see bte.h: mathematics, maps, the equations of a block, its answers,
 * checksums, samples, and at the end the functions of bte.h. The equations are translated from
 * equations.py of calib/estimation; the other functions follow step.py, readout.py, known.py,
 * reasons.py and online.py there.
 */
#include "bte.h"

#include <math.h>
#include <string.h>

#define R(x) ((bte_real)(x))
#define MATH(name) {{ "name##f" if floating == 32 else "name" }}
enum { TERMS = {{ terms }}, LARGEST = {{ largest }} }; /* of the series; argument of exp */

static const bte_real GRAVITY = R(9.80665), Z95 = R(1.96), LN2_HIGH = R(0.693145751953125),
                      LN2_LOW = R(1.42860682030941723e-6);

/* Functions that are not inlined: inlined they would add a tenth to the code. */
#ifdef __GNUC__
#define CALLED __attribute__((noinline))
#else
#define CALLED
#endif
CALLED static bte_real largest(bte_real a, bte_real b) { return a > b ? a : b; }
CALLED static bte_real smallest(bte_real a, bte_real b) { return a < b ? a : b; }
static bte_real clip(bte_real x, bte_real low, bte_real high) {
    return smallest(largest(x, low), high);
}
static bte_real square(bte_real x) { return x * x; }

/* exp(x) = 2^k exp(x - k ln 2), with the nearest integer k, by its series: C libraries differ. */
static bte_real exponential(bte_real x) {
    const bte_real clipped = clip(x, -R(LARGEST), R(LARGEST));
    const int k = (int)(clipped / (LN2_HIGH + LN2_LOW) + (R(LARGEST) + R(0.5))) - LARGEST;
    const bte_real residual = (clipped - (bte_real)k * LN2_HIGH) - (bte_real)k * LN2_LOW;
    bte_real sum = R(1.0);
    for (int n = TERMS; n > 0; n--) {
        sum = R(1.0) + sum * residual / (bte_real)n;
    }
    return MATH(ldexp)(sum, k);
}

/* ln(x) of x = 2^k m, by the series of ln(m) = 2 artanh(f); it needs fewer terms than exp. */
static bte_real logarithm(bte_real x) {
    int k = 0;
    bte_real m = MATH(frexp)(x, &k), sum = R(0.0);
    if (m <= R(0.70710678118654755)) {
        m *= R(2.0);
        k--;
    }
    const bte_real f = (m - R(1.0)) / (m + R(1.0)), f2 = f * f;
    for (int n = 2 * TERMS - 7; n > 0; n -= 2) {
        sum = R(1.0) / (bte_real)n + sum * f2;
    }
    return (bte_real)k * LN2_HIGH + ((bte_real)k * LN2_LOW + R(2.0) * f * sum);
}

/* An interval inside this file: an array of a median, its lower and its upper bound. */
enum { MEDIAN, LOWER, UPPER, ENDS };

/* Add `by` to an interval; the distance d of a bound from the median becomes sqrt(d^2 + more^2). */
static void widen(bte_real x[], bte_real by, bte_real more_lower, bte_real more_upper) {
    const bte_real below = x[LOWER] - x[MEDIAN], above = x[UPPER] - x[MEDIAN];
    x[MEDIAN] += by;
    x[LOWER] = x[MEDIAN] - MATH(sqrt)(square(below) + square(more_lower));
    x[UPPER] = x[MEDIAN] + MATH(sqrt)(square(above) + square(more_upper));
}

/* A place on an axis: the number of a cell, and the position in the cell from 0 to 1. */
typedef struct {
    uint16_t cell;
    bte_real along;
} place;

/* Find the cell of x by bisection; beyond the ends of the axis the nearest end counts. */
static place find(const bte_axis *axis, bte_real x) {
    place at = {0, R(0.0)};
    uint16_t high = (uint16_t)(axis->count - 1U);
    while (at.cell + 1U < high) {
        const uint16_t middle = (uint16_t)((at.cell + high) / 2U);
        if (axis->x[middle] <= x) {
            at.cell = middle;
        } else {
            high = middle;
        }
    }
    const bte_real low = axis->x[at.cell];
    at.along = clip((x - low) / (axis->x[at.cell + 1U] - low), R(0.0), R(1.0));
    return at;
}

/* Read the first columns of a map at a point, linear between its 2, 4 or 8 nearest cells. */
static void look_up(const bte_map *map, const bte_real point[], unsigned columns, bte_real out[]) {
    unsigned corners = 1U, cell[8] = {0};
    bte_real weight[8];
    weight[0] = R(1.0);
    for (unsigned a = 0; a < map->axes; a++) { /* each axis doubles the number of corners */
        const place at = find(&map->axis[a], point[a]);
        for (unsigned i = 0; i < corners; i++) {
            cell[i] = cell[i] * map->axis[a].count + at.cell;
            cell[corners + i] = cell[i] + 1U;
            weight[corners + i] = weight[i] * at.along;
            weight[i] *= R(1.0) - at.along;
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

{{ equations }}

/* Learn the zeros of demand and eta from rolling blocks that lie `waiting` blocks before a bite. */
static void learn_zeros(bte_state *state, const bte_block *x, bool counts) {
    BTE_CAL bte_numbers *c = state->car->numbers;
    bte_filters *s = &state->filters;
    const uint16_t delay = state->car->waiting;
    bte_rolling *oldest = &state->waiting[state->waits % delay];
    widen_zeros(c, s);
    if (x->pressure <= c->bite && state->waits >= delay) {
        take_zeros(c, s, oldest->demand, oldest->eta_less_1, oldest->rim);
    }
    if (rolls(c, s, x, counts) && !state->driven) {
        const bte_rolling latest = {x->demand, x->eta_less_1, x->rim};
        *oldest = latest;
        state->waits++;
    } else {
        state->waits = 0;
    }
}

/* Read ln of the ratio with its bounds, and widen them by the errors of the point. The slope of the
 * map along an axis is that over a step to each side: an error, or a cell if that is smaller. */
static void read_ratio(const bte_car *car, const bte_real point[], const bte_real error[],
                       bte_real ratio[]) {
    const bte_axis *shifts = &car->pads.axis[BTE_SHIFT];
    const uint16_t cell = find(shifts, point[BTE_SHIFT]).cell;
    const bte_real largest_step[] = {R(0.0), shifts->x[cell + 1U] - shifts->x[cell], R(1.0)};
    look_up(&car->pads, point, BTE_COLUMNS, ratio);
    for (unsigned axis = BTE_SHIFT; axis < BTE_MAP_AXES; axis++) {
        const bte_real step = smallest(error[axis], largest_step[axis]);
        bte_real aside[] = {point[BTE_Z], point[BTE_SHIFT], point[BTE_SLIP]};
        bte_real low, high;
        aside[axis] = point[axis] - step;
        look_up(&car->pads, aside, 1U, &low);
        aside[axis] = point[axis] + step;
        look_up(&car->pads, aside, 1U, &high);
        const bte_real more = R(0.5) * Z95 * error[axis] * ((high - low) / step);
        widen(ratio, R(0.0), more, more);
    }
}

/* Move an interval towards y by a share. */
static void blend(bte_real x[], const bte_real y[], bte_real share) {
    for (unsigned k = 0; k < ENDS; k++) {
        x[k] = (R(1.0) - share) * x[k] + share * y[k];
    }
}

/* Return ln of the held ratio of the pads, with bounds that a variance widens. */
static void held_ratio(const bte_state *state, bte_real variance, bte_real ratio[]) {
    const bte_real more = Z95 * MATH(sqrt)(variance);
    (void)memcpy(ratio, state->ratio, sizeof state->ratio);
    widen(ratio, R(0.0), more, more);
}

/* Blend a reading of the ratio into the held ratio, the more the narrower it is. The result replaces
 * the reading. A new stop replaces the held ratio; otherwise the reading counts where it `adds`. */
static void best_ratio(bte_state *state, bte_real ratio[], bte_real level, bool is_new, bool adds) {
    BTE_CAL bte_numbers *c = state->car->numbers;
    bte_filters *s = &state->filters;
    bte_real held[ENDS];
    s->age += c->block;
    held_ratio(state, held_variance(c, s, level), held);
    bte_real share = is_new ? R(1.0) : R(0.0);
    if (adds && !is_new) {
        share = share_of(c, ratio[UPPER] - ratio[LOWER], held[UPPER] - held[LOWER]);
    }
    blend(state->ratio, ratio, share);
    held_ratio(state, reset_held(c, s, level, share), ratio);
}

/* Compute y = by exp(ln), for the median and its bounds. */
static void scale(bte_interval *y, bte_real by, const bte_real ln[]) {
    bte_real *ends = (bte_real *)y;
    for (unsigned k = 0; k < ENDS; k++) {
        ends[k] = by * exponential(ln[k]);
    }
}

/* Answer level, ratio and friction of the pads by ln of level and ratio. */
static void answer_pads(bte_state *s, const bte_real level[], const bte_real ratio[]) {
    BTE_CAL bte_numbers *c = s->car->numbers;
    bte_answers *y = &s->answers;
    const bte_real friction_f = c->pad_friction[BTE_FRONT], friction_r = c->pad_friction[BTE_REAR];
    bte_real front[ENDS], rear[ENDS], more_f[ENDS], more_r[ENDS];
    bte_real *pad_ratio = (bte_real *)&y->pad_ratio;
    for (unsigned k = 0; k < ENDS; k++) {
        const bte_real changed = exponential(ratio[k]);
        pad_ratio[k] = friction_f / friction_r * changed;
        /* ln of the friction of an axle over the level */
        more_r[k] = -logarithm(c->share * changed + (R(1.0) - c->share));
        more_f[k] = ratio[k] + more_r[k];
        front[k] = level[k];
        rear[k] = level[k];
    }
    /* the friction of the front pads rises with the ratio, that of the rear pads falls */
    widen(front, more_f[MEDIAN], more_f[MEDIAN] - more_f[LOWER], more_f[MEDIAN] - more_f[UPPER]);
    widen(rear, more_r[MEDIAN], more_r[MEDIAN] - more_r[UPPER], more_r[MEDIAN] - more_r[LOWER]);
    scale(&y->pad_level, R(1.0), level);
    scale(&y->pad_friction_f, friction_f, front);
    scale(&y->pad_friction_r, friction_r, rear);
}

/* Compute y = by x. */
CALLED static void times(bte_interval *y, bte_real by, const bte_interval *x) {
    const bte_interval product = {by * x->median, by * x->lower, by * x->upper};
    *y = product;
}

/* Answer torques by the pads of the last block and the present pressure. */
static void answer_torques(bte_state *s) {
    BTE_CAL bte_numbers *c = s->car->numbers;
    bte_answers *y = &s->answers;
    const bte_real p_mc = largest(s->last.p_mc, R(0.0));
    times(&y->brake_torque_fl, c->torque_gain[BTE_FRONT] * p_mc, &y->pad_friction_f);
    times(&y->brake_torque_rl, c->torque_gain[BTE_REAR] * p_mc, &y->pad_friction_r);
    y->brake_torque_fr = y->brake_torque_fl;
    y->brake_torque_rr = y->brake_torque_rl;
    const bte_real sum = R(2.0) * (y->brake_torque_fl.median + y->brake_torque_rl.median);
    times(&y->brake_torque_sum, sum / y->pad_level.median, &y->pad_level);
}

/* Add a number to a checksum: FNV-1a, by words of 32 bits instead of bytes, the lower word first. */
CALLED static uint32_t fnv_real(uint32_t sum, bte_real x) {
    uint{{ floating }}_t bits;
    (void)memcpy(&bits, &x, sizeof bits);
    const uint64_t wide = bits;
    const uint64_t low = ((sum ^ (wide & 0xFFFFFFFFU)) * 16777619U) & 0xFFFFFFFFU;
    return (uint32_t)(((low ^ (wide >> 32U)) * 16777619U) & 0xFFFFFFFFU);
}

static uint32_t fnv_reals(uint32_t sum, const volatile bte_real x[], uint32_t count) {
    uint32_t so_far = sum;
    for (uint32_t i = 0; i < count; i++) {
        so_far = fnv_real(so_far, x[i]);
    }
    return so_far;
}

/* First numbers of the filters, which outlast a reset: both zeros and the lag, their variances. */
enum { LASTING = 6 };

CALLED static uint32_t seal_of(const bte_state *s) {
    const bte_real *lasting = (const bte_real *)&s->filters;
    return fnv_reals(BTE_LAYOUT ^ (uint32_t)sizeof *s, lasting, LASTING);
}

/* Take in a block, and answer its pads. */
static void take_block(bte_state *state, const bte_block *x) {
    const bte_car *car = state->car;
    BTE_CAL bte_numbers *c = car->numbers;
    const bool usual = x->rim > c->moving && state->worst == BTE_VALID;
    brake_line_lag(c, &state->filters, x->nominal);
    const bool fits = motor_fits(c, &state->filters, x, usual), counts = usual && fits;
    learn_zeros(state, x, counts);
    step_filters(c, &state->filters, x, counts);
    const bte_filters *s = &state->filters;
    const bool is_new = s->means.blocks == R(0.0);
    const bte_real z = is_new ? c->usual_z : s->mean_z, eta_by_z = s->means.eta_rise / z;
    bte_real point[BTE_MAP_AXES] = {z, eta_by_z, R(0.0)}, by_map[BTE_COLUMNS];
    look_up(&car->slip, point, 2U, by_map);
    bte_real level[ENDS], ratio[ENDS], prior[ENDS];
    look_up(&car->level, point, BTE_COLUMNS, level);
    const bte_slip_evidence w = slip_evidence(c, s, z, by_map[0], by_map[1]);
    const bte_real more = Z95 * MATH(sqrt)(w.noise + w.accelerometer);
    widen(level, logarithm(w.pads * w.scaled), more, more);
    /* the ratio of the pads: read at eta, blended with the prior, then with the held ratio */
    const bte_axis *shifts = &car->pads.axis[BTE_SHIFT];
    const bool of_map = eta_by_z >= shifts->x[0] && eta_by_z <= shifts->x[shifts->count - 1U];
    point[BTE_SLIP] = w.slip;
    const bte_real error[BTE_MAP_AXES] = {R(0.0), eta_error(c, s, z) / z, w.slip_sigma};
    read_ratio(car, point, error, ratio);
    look_up(&car->prior, point, BTE_COLUMNS, prior);
    const bte_real narrowed = (ratio[UPPER] - ratio[LOWER]) / (prior[UPPER] - prior[LOWER]);
    const bool readable = !is_new && of_map && z >= c->least_z;
    const bte_real share = readable ? share_of(c, narrowed, R(1.0)) : R(0.0);
    blend(ratio, prior, R(1.0) - share);
    /* width over that of the prior; its square is the prior's share of the variance */
    const bte_real width = R(1.0) + share * (narrowed - R(1.0));
    widen(ratio, square(width) * (c->ramp_ratio - prior[MEDIAN]), R(0.0), R(0.0));
    best_ratio(state, ratio, w.pads, is_new, counts && x->pressure > c->bite);
    answer_pads(state, level, ratio);
    const bte_real median = state->answers.pad_level.median;
    state->checks = (uint16_t)s->checks;
    state->block_reason = (bte_reason)reason_of(c, x, s, median, of_map);
    state->seal = seal_of(state);
}

/* Return the slip of an axle by force and load over the weight of the car, by the tyre curve. */
static bte_real slip_at(const bte_car *car, bte_real force, bte_real load) {
    const place at = find(&car->tyre, force / largest(load, R(0.1)));
    const bte_real low = car->tyre_slip[at.cell], high = car->tyre_slip[at.cell + 1U];
    return low + at.along * (high - low);
}

/* Take in a sample, and return the bits of the sensors that fail: those that read a value out of
 * range, or one too far from the last reading in range. Their last good reading counts. */
static uint32_t take_sample(bte_state *s, const bte_inputs *inputs) {
    BTE_CAL bte_numbers *c = s->car->numbers;
    const bte_real *x = (const bte_real *)inputs; /* the inputs by their number */
    bte_real *last = (bte_real *)&s->last;
    uint32_t failing = 0U;
    for (unsigned i = 0; i < (unsigned)BTE_INPUTS; i++) {
        const bool inside = x[i] >= c->low[i] && x[i] <= c->high[i];
        const bool jumps = s->started && MATH(fabs)(x[i] - s->raw[i]) > c->change[i];
        s->raw[i] = inside ? x[i] : s->raw[i];
        if (inside && !jumps) {
            last[i] = x[i];
        } else {
            failing |= (uint32_t)1U << i;
        }
    }
    return failing;
}

/* Count in how many calls each diagnosis fails, and how often it began to. */
static void diagnose(bte_state *s, uint32_t failing) {
    const uint32_t begins = failing & ~s->diagnosis;
    for (unsigned i = 0; failing != 0U && i < (unsigned)BTE_DIAGNOSES; i++) {
        s->often[i] = (uint16_t)(s->often[i] + ((begins >> i) & 1U));
        s->lasted[i] += (failing >> i) & 1U;
    }
    s->diagnosis = failing;
}

/* Return the reason that the signals alone show; `fine`: whether all sensors work. */
static bte_reason disturbance(bte_state *s, bool fine) {
    BTE_CAL bte_numbers *c = s->car->numbers;
    const bte_inputs *x = &s->last;
    const bte_real omega[BTE_WHEELS] = {x->omega_fl, x->omega_fr, x->omega_rl, x->omega_rr};
    bte_real fastest = s->fastest - c->slowing, slowest = R(1e9);
    for (unsigned w = 0; w < (unsigned)BTE_WHEELS; w++) {
        bte_real *past = s->wheels[w];
        if (!s->started) {
            past[0] = omega[w];
            past[1] = omega[w];
        }
        const bte_real low = smallest(past[0], past[1]), high = largest(past[0], past[1]);
        const bte_real median = clip(omega[w], low, high); /* of three samples */
        past[0] = past[1];
        past[1] = omega[w];
        fastest = largest(fastest, median);
        slowest = smallest(slowest, median);
    }
    const bte_real mean = R(0.5) * (x->omega_rl + x->omega_rr);
    const bte_real speed = c->rolling_radius[BTE_REAR] * mean, z = -x->a_x / GRAVITY;
    s->fastest = fastest;
    const bool is_slow = fastest - slowest > c->lock * largest(fastest, R(1.0));
    const bool locks = is_slow && fastest > c->turning;
    s->since_lock = locks ? R(0.0) : s->since_lock + c->sample_time;
    s->since_abs = x->abs_active > R(0.5) ? R(0.0) : s->since_abs + c->sample_time;
    /* apart = lateral (track_width/speed^2 + leaning slip), see calib/run/lateral.py */
    const bte_real apart = (x->omega_rr - x->omega_rl) / largest(mean, R(1.0));
    const bte_real slip = largest(slip_at(s->car, z, R(1.0)), R(0.0));
    const bte_real by_bend = c->track_width / square(largest(speed, c->moving));
    const bte_real lateral = apart / (by_bend + c->leaning * slip);
    s->lateral = s->started ? s->lateral + c->lateral_part * (lateral - s->lateral) : lateral;
    bte_reason why;
    if (!fine) {
        why = BTE_FAULT;
    } else if (s->since_abs <= c->recent) {
        why = BTE_ABS;
    } else if (s->since_lock <= c->recent) {
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

/* Make a block from the sums, and take it in: the force balance (1), (5) to (7) of the paper, with
 * known drag and rolling resistance. Forces are over the weight of the car. */
static void block_ends(bte_state *s) {
    const bte_car *car = s->car;
    BTE_CAL bte_numbers *c = car->numbers;
    bte_sums_of_block mean = s->sum;
    bte_real *means = (bte_real *)&mean;
    for (unsigned i = 0; i < sizeof mean / sizeof mean.z; i++) {
        means[i] /= (bte_real)car->samples;
    }
    const bte_real z = mean.z, front = mean.omega_f;
    const bte_real omega[BTE_AXLES] = {front, front + mean.apart};
    const bte_real drive[BTE_AXLES] = {mean.drive_f, mean.drive_r};
    bte_real load[BTE_AXLES], other[BTE_AXLES], driven[BTE_AXLES], driving = R(0.0);
    const bte_real speed = c->rolling_radius[BTE_REAR] * omega[BTE_REAR];
    const bte_real body = c->drag * square(speed);
    const bte_real rolling = c->rolling + c->rolling_growth * square(speed);
    const bool is_stale = s->faulty || s->failed; /* then the wheels' speeds give no acceleration */
    bte_real demanded = z - body;
    for (unsigned a = 0; a < (unsigned)BTE_AXLES; a++) {
        bte_real spin = s->block_full ? (omega[a] - s->omega[a]) / c->block : R(0.0);
        spin = is_stale ? -GRAVITY * z / c->rolling_radius[a] : spin;
        s->omega[a] = omega[a];
        load[a] = c->load[a] + c->height[a] * z;
        driving += c->drive[a] * drive[a];
        other[a] = rolling * load[a] - c->drive[a] * drive[a];
        demanded -= other[a] + c->spinning[a] * spin;
    }
    s->block_full = true;
    s->faulty = s->failed;
    /* slips that motors, drag and rolling resistance add to those of the brakes alone */
    const bte_real z_alone = demanded / c->rolls;
    for (unsigned a = 0; a < (unsigned)BTE_AXLES; a++) {
        const bte_real tyre = c->ramp_share[a] * demanded - c->turns[a] * z_alone;
        const bte_real alone = c->load[a] + c->height[a] * z_alone;
        load[a] += c->drag_lift[a] * body;
        driven[a] = slip_at(car, tyre + other[a], load[a]) - slip_at(car, tyre, alone);
    }
    /* eta of the brakes alone: omega_r/(1 - driven_r) over omega_f/(1 - driven_f) */
    const bte_real eta_less_1 = front > R(0.0) ? mean.apart / front : R(0.0);
    const bte_real eta = eta_less_1 + driven[BTE_REAR] - driven[BTE_FRONT] * (R(1.0) + eta_less_1);
    const bte_real rim = c->rolling_radius[BTE_FRONT] * front / (R(1.0) - driven[BTE_FRONT]);
    bte_block block;
    block.demand = demanded;
    block.nominal = c->force * mean.p_mc;
    block.pressure = mean.p_mc;
    block.z = z;
    block.eta_less_1 = eta / (R(1.0) - driven[BTE_REAR]);
    block.eta_by_drive = block.eta_less_1 - eta_less_1;
    block.rim = largest(rim, c->slowest);
    block.rear_share = load[BTE_REAR];
    block.disturbed = (bte_real)s->worst;
    block.drive = driving;
    take_block(s, &block);
}

/* Begin with the data of a car, without knowledge of its pads. */
static void begin(bte_state *s, const bte_car *car) {
    BTE_CAL bte_numbers *c = car->numbers;
    const bte_real any[] = {R(0.0), logarithm(c->least_level), logarithm(c->most_level)};
    (void)memset(s, 0, sizeof *s);
    s->reason = (uint32_t)BTE_NOT_BRAKED;
    s->block_reason = BTE_NOT_BRAKED;
    s->layout = BTE_LAYOUT;
    s->car = car;
    s->since_lock = R(2.0) * c->recover;
    s->since_abs = s->since_lock;
    start(c, &s->filters);
    answer_pads(s, any, any);
}

/* Whether data fit this code and this compiler. */
static bool is_taken(const bte_car *car) {
    return car->layout == BTE_LAYOUT && car->size == sizeof(bte_car) + sizeof(bte_numbers)
           && car->waiting - 1U < 3U; /* waiting is 1 to 3: the state has room for 3 blocks */
}

/* Begin with the data of a car, but keep the zeros and the lag, if that is allowed. */
static bool begin_again(bte_state *s, const bte_car *car, bool allowed) {
    const bool taken = allowed && is_taken(car);
    if (taken) {
        bte_real lasts[LASTING];
        (void)memcpy(lasts, &s->filters, sizeof lasts);
        begin(s, car);
        (void)memcpy(&s->filters, lasts, sizeof lasts);
        s->seal = seal_of(s);
    }
    return taken;
}

static uint32_t fnv_map(uint32_t sum, const bte_map *map) {
    uint32_t cells = 1U, so_far = sum;
    for (unsigned a = 0; a < map->axes; a++) {
        cells *= map->axis[a].count;
        so_far = fnv_reals(so_far, map->axis[a].x, map->axis[a].count);
    }
    for (unsigned k = 0; k < map->columns; k++) {
        so_far = fnv_real(so_far, map->step[k]);
        for (uint32_t i = 0; i < cells; i++) {
            so_far = fnv_real(so_far, (bte_real)map->cells[k][i]);
        }
    }
    return so_far;
}

/* Checksum of the data of a car, which car_data.py computes as well. */
static uint32_t checksum(const bte_car *car) {
    BTE_CAL bte_real *numbers = (BTE_CAL bte_real *)car->numbers; /* all of one type */
    uint32_t sum = fnv_reals(0U, numbers, (uint32_t)(sizeof *car->numbers / sizeof *numbers));
    sum = fnv_map(fnv_map(sum, &car->pads), &car->slip);
    sum = fnv_map(fnv_map(sum, &car->level), &car->prior);
    return fnv_reals(fnv_reals(sum, car->tyre.x, car->tyre.count), car->tyre_slip, car->tyre.count);
}

bte_status bte_init(bte_state *s, const bte_car *car) {
    bte_status status = BTE_REFUSED;
    (void)memset(s, 0, sizeof *s);
    if (is_taken(car)) {
        begin(s, car);
        s->seal = seal_of(s);
        status = checksum(car) == car->checksum ? BTE_READY : BTE_CALIBRATED;
    }
    return status;
}

bool bte_exchange(bte_state *s, const bte_car *car) {
    const bte_real rests = s->layout == BTE_LAYOUT ? s->car->numbers->rests : R(0.0);
    const bte_real front = MATH(fabs)(s->omega[BTE_FRONT]), rear = MATH(fabs)(s->omega[BTE_REAR]);
    return begin_again(s, car, largest(front, rear) < rests);
}

bool bte_resume(bte_state *s, const bte_car *car) {
    return begin_again(s, car, s->layout == BTE_LAYOUT && s->seal == seal_of(s));
}

/* Take in a sample, and at the end of a block the block. */
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
