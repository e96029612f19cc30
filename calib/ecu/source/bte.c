/* The estimator of brake-cal, see bte.h. Equations: calib/estimation/state.py and step.py, which
 * this file follows line by line; calib/ecu/online.py for what is before a block and behind it.
 * Where float32 would lose digits, a difference stands that Python does not need.
 */
#include "bte.h"

#include <math.h>
#include <string.h>

#define R(x) ((bte_real)(x))

#if BTE_FLOAT == 64
typedef uint64_t bte_bits;
#define BTE_SQRT(x) sqrt(x)
#define MANTISSA 52
#define BIAS 1023
#define EXP_TERMS 15U
#define LOG_TERMS 11U
#define LARGEST R(700.0)
#else
typedef uint32_t bte_bits;
#define BTE_SQRT(x) sqrtf(x)
#define MANTISSA 23
#define BIAS 127
#define EXP_TERMS 9U
#define LOG_TERMS 5U
#define LARGEST R(87.0)
#endif

static const bte_real GRAVITY = R(9.80665);
static const bte_real Z95 = R(1.96);

static bte_real largest(bte_real a, bte_real b) { return a > b ? a : b; }
static bte_real smallest(bte_real a, bte_real b) { return a < b ? a : b; }
static bte_real clip(bte_real x, bte_real low, bte_real high) {
    return smallest(largest(x, low), high);
}
static bte_real size_of(bte_real x) { return x < R(0.0) ? -x : x; }
static bte_real square(bte_real x) { return x * x; }
static bte_real root(bte_real x) { return BTE_SQRT(x); }

/* Own exp and ln: those of C libraries differ in the last digits. x within LARGEST. Their terms are
 * 1/n! of x^n, and 1/(2 n + 1) of x^(2 n + 1); float32 needs the first ones.
 */
static bte_real exponential(bte_real x) {
    static const bte_real exp_term[] = {
        R(1.0), R(1.0), R(0.5), R(0.16666666666666666), R(0.041666666666666664),
        R(0.008333333333333333), R(0.001388888888888889), R(0.0001984126984126984),
        R(2.48015873015873e-05), R(2.7557319223985893e-06), R(2.755731922398589e-07),
        R(2.505210838544172e-08), R(2.08767569878681e-09), R(1.6059043836821613e-10),
        R(1.1470745597729725e-11)
    };
    const bte_real held = clip(x, -LARGEST, LARGEST);
    const bte_real turns = held * R(1.4426950408889634);
    const int32_t k = (int32_t)(turns + (turns < R(0.0) ? R(-0.5) : R(0.5)));
    const bte_real n_ln2 = (bte_real)k * R(0.693145751953125); /* ln 2 in two parts */
    const bte_real rest = (held - n_ln2) - (bte_real)k * R(1.42860682030941723e-6);
    bte_real sum = R(0.0);
    for (unsigned n = EXP_TERMS; n > 0U; n--) {
        sum = exp_term[n - 1U] + sum * rest;
    }
    const int32_t exponent = k + BIAS;
    const bte_bits bits = (bte_bits)exponent << MANTISSA;
    bte_real power;
    (void)memcpy(&power, &bits, sizeof power);
    return sum * power;
}

static bte_real logarithm(bte_real x) {
    static const bte_real log_term[] = {
        R(1.0), R(0.3333333333333333), R(0.2), R(0.14285714285714285), R(0.1111111111111111),
        R(0.09090909090909091), R(0.07692307692307693), R(0.06666666666666667),
        R(0.058823529411764705), R(0.05263157894736842), R(0.047619047619047616)
    };
    bte_bits bits;
    (void)memcpy(&bits, &x, sizeof bits);
    int32_t k = (int32_t)(bits >> MANTISSA) - BIAS;
    const bte_bits one = (bte_bits)BIAS << MANTISSA;
    const bte_bits fraction = (bits & (((bte_bits)1 << MANTISSA) - 1U)) | one;
    bte_real m;
    (void)memcpy(&m, &fraction, sizeof m);
    if (m > R(1.4142135623730951)) {
        m = m * R(0.5);
        k = k + 1;
    }
    const bte_real f = (m - R(1.0)) / (m + R(1.0)), f2 = f * f;
    bte_real sum = R(0.0);
    for (unsigned n = LOG_TERMS; n > 0U; n--) {
        sum = log_term[n - 1U] + sum * f2;
    }
    const bte_real low = (bte_real)k * R(1.42860682030941723e-6) + R(2.0) * f * sum;
    return (bte_real)k * R(0.693145751953125) + low;
}

/* A median with its bounds, these farther away by `more`, added as squares. */
static void widen(bte_real x[BTE_BOUNDS], bte_real more_lower, bte_real more_upper) {
    const bte_real below = x[BTE_LOWER] - x[BTE_MEDIAN], above = x[BTE_UPPER] - x[BTE_MEDIAN];
    x[BTE_LOWER] = x[BTE_MEDIAN] - root(square(below) + square(more_lower));
    x[BTE_UPPER] = x[BTE_MEDIAN] + root(square(above) + square(more_upper));
}

#ifndef BTE_FIND /* for the search of the house; the last point has `along` 1 in the last cell */
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

static bte_real width(const bte_axis *axis, bte_real x) {
    const bte_place place = BTE_FIND(axis, x);
    return axis->x[place.at + 1U] - axis->x[place.at];
}

static bte_real on_line(BTE_CAL bte_cell *cells, bte_real step, bte_place place) {
    const bte_real low = (bte_real)cells[place.at], high = (bte_real)cells[place.at + 1U];
    return step * (low * (R(1.0) - place.along) + high * place.along);
}

/* The corners of the cell of the map of the ratio around a place, with their weights. */
typedef struct {
    uint16_t cell[8], row[8]; /* of a map over all axes, and of one without the last */
    bte_real weight[8];
} bte_corners;

static void corners(const bte_car *car, const bte_real at[3], bte_corners *out) {
    const bte_place z = BTE_FIND(&car->z, at[0]), shift = BTE_FIND(&car->shift, at[1]),
                    slip = BTE_FIND(&car->slip, at[2]);
    for (unsigned i = 0; i < 8U; i++) {
        const unsigned a = i >> 2, b = (i >> 1) & 1U, c = i & 1U;
        const unsigned row = (z.at + a) * car->shift.count + shift.at + b;
        out->row[i] = (uint16_t)row;
        out->cell[i] = (uint16_t)(row * car->slip.count + slip.at + c);
        out->weight[i] = (a ? z.along : R(1.0) - z.along)
                         * (b ? shift.along : R(1.0) - shift.along)
                         * (c ? slip.along : R(1.0) - slip.along);
    }
}

static bte_real weighed(BTE_CAL bte_cell *cells, const uint16_t place[8],
                        const bte_real weight[8]) {
    bte_real sum = R(0.0);
    for (unsigned i = 0; i < 8U; i++) {
        sum += weight[i] * (bte_real)cells[place[i]];
    }
    return sum;
}

static bte_real in_map(BTE_CAL bte_cell *cells, bte_real step, const bte_corners *at) {
    return step * weighed(cells, at->cell, at->weight);
}

/* --- what is remembered: calib/estimation/state.py ------------------------------------------- */

static void measure(bte_zero *zero, bte_real x, bte_real variance) {
    const bte_real gain = zero->variance / (zero->variance + variance);
    zero->value += gain * (x - zero->value);
    zero->variance *= R(1.0) - gain;
}

static void age_zero(bte_zero *zero, bte_real walk, bte_real dt, bte_real most) {
    zero->variance = smallest(zero->variance + square(walk) * dt, most);
}

static bte_real block_time(const bte_car *car) {
    return (bte_real)car->samples * car->sample_time;
}

/* eta over its zero, less 1. Both are kept less 1: near 1 float32 is coarse. */
static bte_real eta_over_zero(const bte_state *s, const bte_block *x) {
    return (x->eta_less_1 - s->eta_less_1.value) / (R(1.0) + s->eta_less_1.value);
}

static bte_real rim_of(const bte_state *s, const bte_block *x) {
    return x->rim + x->rim * x->rear_share * eta_over_zero(s, x);
}

static void forget_stop(bte_state *s) {
    const bte_tuning *c = &s->car->tuning;
    const bte_real lag = s->level[1], variance = s->level[6];
    (void)memset(s->level, 0, sizeof s->level);
    s->level[0] = R(1.0);
    s->level[1] = lag;
    s->level[3] = square(c->level_sigma);
    s->level[6] = variance;
    s->level[8] = square(c->fade);
    s->braked = R(0.0);
    (void)memset(s->sums, 0, sizeof s->sums);
    s->mean_z = R(0.0);
}

/* Zeros, from blocks that lie far enough before a bite. */
static void roll(bte_state *s, const bte_block *x, bool counts) {
    const bte_tuning *c = &s->car->tuning;
    const bte_real dt = block_time(s->car);
    if (s->waits >= s->car->waiting) {
        const bte_real wheels = c->noise_rim / s->waiting[0].rim;
        measure(&s->demand, s->waiting[0].demand, (square(c->noise_z) + R(1e-8)) / dt);
        measure(&s->eta_less_1, s->waiting[0].eta_less_1, R(2.0) * square(wheels) / dt);
        s->waits--;
        for (unsigned i = 0; i < s->waits; i++) {
            s->waiting[i] = s->waiting[i + 1U];
        }
    }
    if (counts && !x->driven && x->pressure < c->untouched && size_of(x->z) < c->steady) {
        s->waiting[s->waits].demand = x->demand;
        s->waiting[s->waits].eta_less_1 = x->eta_less_1;
        s->waiting[s->waits].rim = x->rim;
        s->waits++;
    } else {
        s->waits = 0;
    }
}

/* Nominal brake force behind its lag, and its slope by the lag, exact for a straight rise. */
static void press(bte_state *s, bte_real nominal) {
    const bte_real dt = block_time(s->car), lag = largest(s->level[1], s->car->tuning.least_lag);
    const bte_real left = exponential(-dt / lag), rate = (nominal - s->nominal) / dt;
    const bte_real behind = s->acting - s->nominal + lag * rate;
    s->by_lag = -rate + (s->by_lag + rate) * left + behind * left * dt / square(lag);
    s->acting = nominal - lag * rate + behind * left;
    s->nominal = nominal;
}

/* Level and lag; means of what goes into the map. */
static void brake(bte_state *s, const bte_block *x) {
    const bte_tuning *c = &s->car->tuning;
    const bte_real y = x->demand - s->demand.value, dt = block_time(s->car);
    bte_real *l = s->level;
    l[0] += l[2] * dt;
    l[3] += dt * (R(2.0) * l[5] + dt * l[8]) + square(c->level_walk * l[0]) * dt;
    l[4] += dt * l[7];
    l[5] += dt * l[8];
    l[8] += square(c->fade_walk * l[0]) * dt;
    const bte_real h = s->acting, k = l[0] * s->by_lag;
    bte_real pa = h * l[3] + k * l[4];
    const bte_real pl = h * l[4] + k * l[6], pr = h * l[5] + k * l[7];
    const bte_real to_come = c->lag_rough * l[0] * (x->nominal - h);
    const bte_real rough = square(c->level_rough * y) + square(to_come);
    bte_real spread = h * pa + k * pl + square(c->noise_z) / dt + rough;
    const bte_real off_by = y - l[0] * h;
    const bte_real jump = smallest(square(off_by) - square(c->jump) * spread,
                                   square(c->level_sigma * h));
    bte_real keep = exponential(-dt / c->memory);
    if (jump > R(0.0)) { /* pads that change at once: what no noise explains */
        l[3] += jump / square(h);
        pa += jump / h;
        keep *= spread / (spread + jump);
        spread += jump;
    }
    const bte_real gain = R(1.0) / spread, off = gain * off_by, ga = gain * pa, gl = gain * pl;
    l[0] += off * pa;
    l[1] = largest(l[1] + off * pl, R(0.0));
    l[2] += off * pr;
    l[3] -= ga * pa;
    l[4] -= ga * pl;
    l[5] -= ga * pr;
    l[6] -= gl * pl;
    l[7] -= gl * pr;
    l[8] -= gain * pr * pr;
    s->sums[0] = keep * s->sums[0] + R(1.0);
    s->sums[1] = keep * s->sums[1] + y;
    s->sums[2] = keep * s->sums[2] + eta_over_zero(s, x);
    s->sums[3] = keep * s->sums[3] + y * y;
    s->mean_z = largest(s->sums[1] / s->sums[0], c->least_mean_z);
}

/* States of `speed`: v, ln(slip/z), offset, scale; then the upper half of their covariance. */
enum { V, S, O, E, VV, VS, VO, VE, SS, SO, SE, OO, OE, EE };

/* The speed by a_x, until it is measured; `bends` by how much the mean deceleration changed. */
static void move(bte_state *s, const bte_block *x, bte_real bends, bool braking) {
    const bte_tuning *c = &s->car->tuning;
    bte_real *p = s->speed;
    if (!s->anchored) { /* radii that are made equal now would look like a speed that jumps */
        (void)memset(p, 0, sizeof s->speed);
        p[V] = rim_of(s, x);
        p[E] = c->scale;
        p[VV] = R(1.0);
        p[OO] = square(c->offset);
        p[EE] = square(c->scale_sigma);
        s->anchored = braking || s->eta_less_1.variance < R(0.5) * square(c->zero);
    }
    const bte_real dt = block_time(s->car);
    const bte_real lost = GRAVITY * dt * (R(0.5) * (x->z + s->z) - p[O]);
    const bte_real scaled = braking ? R(1.0) - p[E] : R(1.0);
    const bte_real by_o = GRAVITY * dt * scaled, by_e = braking ? lost : R(0.0);
    p[V] -= lost * scaled;
    const bte_real pv = p[VV] + by_o * p[VO] + by_e * p[VE];
    p[VS] += by_o * p[SO] + by_e * p[SE];
    p[VO] += by_o * p[OO] + by_e * p[OE];
    p[VE] += by_o * p[OE] + by_e * p[EE];
    p[VV] = pv + by_o * p[VO] + by_e * p[VE];
    p[VV] += square(GRAVITY * c->noise_z) * dt + square(GRAVITY * c->apart * (x->z - s->z));
    p[OO] += square(c->grade_walk) * dt;
    if (s->braked > dt) {
        p[SS] += square(c->slip_walk) * dt + c->slip_bends * bends;
    } else {
        p[S] = c->log_slip;
        p[VS] = R(0.0);
        p[SO] = R(0.0);
        p[SE] = R(0.0);
        p[SS] = square(c->log_slip_sigma);
    }
}

/* The speed by the wheels; what does not fit is offset, scale and slip. */
static void see_speed(bte_state *s, const bte_block *x, bool braking) {
    const bte_tuning *c = &s->car->tuning;
    const bte_real least_log_slip = R(-8.0), most_log_slip = R(0.0);
    bte_real *p = s->speed;
    const bte_real over = largest(x->demand - s->demand.value, R(0.0));
    const bte_real slip = braking ? over * exponential(p[S]) : R(0.0);
    const bte_real h = R(1.0) - slip, k = -p[V] * slip, rest = (rim_of(s, x) - p[V]) - k;
    const bte_real variance = square(c->noise_rim) / block_time(s->car)
                              + square(c->slip_rough * slip * p[V]);
    const bte_real pv = h * p[VV] + k * p[VS], ps = h * p[VS] + k * p[SS];
    const bte_real po = h * p[VO] + k * p[SO], pe = h * p[VE] + k * p[SE];
    const bte_real gain = R(1.0) / (h * pv + k * ps + variance), y = gain * rest;
    const bte_real gv = gain * pv, gs = gain * ps, go = gain * po;
    p[V] += y * pv;
    p[S] = clip(p[S] + y * ps, least_log_slip, most_log_slip);
    p[O] += y * po;
    p[E] += y * pe;
    p[VV] -= gv * pv;
    p[VS] -= gv * ps;
    p[VO] -= gv * po;
    p[VE] -= gv * pe;
    p[SS] -= gs * ps;
    p[SO] -= gs * po;
    p[SE] -= gs * pe;
    p[OO] -= go * po;
    p[OE] -= go * pe;
    p[EE] -= gain * pe * pe;
}

static void follow(bte_state *s, const bte_block *x) {
    const bte_tuning *c = &s->car->tuning;
    const bte_real dt = block_time(s->car), most = square(c->zero);
    age_zero(&s->demand, c->bias_walk, dt, most);
    age_zero(&s->eta_less_1, c->radius_walk, dt, most);
    const bool braking = x->pressure > c->bite;
    const bool counts = x->rim > c->moving && x->disturbed == BTE_VALID;
    press(s, x->nominal);
    const bte_real before = s->mean_z;
    if (braking) {
        s->waits = 0;
        s->braked += dt;
        s->released = R(0.0);
        if (counts) {
            brake(s, x);
        }
    } else {
        s->released += dt;
        if (s->braked > R(0.0) && s->released > R(1.0) + R(0.5) * dt) {
            forget_stop(s);
        }
        roll(s, x, counts);
    }
    move(s, x, size_of(s->mean_z - before), braking);
    if (counts) {
        see_speed(s, x, braking);
    }
    s->z = x->z;
}

/* --- what is told: calib/estimation/step.py -------------------------------------------------- */

/* Standard deviation of the mean of eta - 1 by wheels, zero and a changing z. */
static bte_real eta_error(const bte_state *s, bte_real shift, bte_real z, bte_real blocks) {
    const bte_real many = largest(blocks, R(1.0));
    bte_real wheels = s->car->tuning.noise_rim / largest(s->speed[V], R(1.0));
    wheels = wheels / root(block_time(s->car) * many);
    const bte_real bent = shift * largest(s->sums[3] / many / square(z) - R(1.0), R(0.0));
    return root(square(wheels) + s->eta_less_1.variance + square(bent));
}

/* ln of the ratio with its bounds, wider by the errors of where the map is read. */
static void read_ratio(const bte_car *car, const bte_real at[3], const bte_real error[2],
                       bte_real out[BTE_BOUNDS]) {
    const bte_real most[2] = {width(&car->shift, at[1]), R(1.0)};
    bte_corners cell;
    corners(car, at, &cell);
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        out[b] = in_map(car->ratio[b], car->ratio_step[b], &cell);
    }
    for (unsigned axis = 0; axis < 2U; axis++) {
        const bte_real step = smallest(error[axis], most[axis]);
        bte_real end[2];
        for (unsigned i = 0; i < 2U; i++) {
            bte_real place[3] = {at[0], at[1], at[2]};
            place[axis + 1U] += i == 0U ? -step : step;
            corners(car, place, &cell);
            end[i] = in_map(car->ratio[BTE_MEDIAN], car->ratio_step[BTE_MEDIAN], &cell);
        }
        const bte_real more = R(0.5) * Z95 * (error[axis] / step) * (end[1] - end[0]);
        widen(out, more, more);
    }
}

/* The best informed ratio so far; it ages as pads warm up, and those that changed did so unlike. */
static void keep_best(bte_state *s, const bte_real now[BTE_BOUNDS], bte_real pads, bool is_new,
                      bte_real best[BTE_BOUNDS]) {
    const bte_tuning *c = &s->car->tuning;
    bte_real variance = square(c->ageing) * s->age
                        + square(c->unlike * logarithm(pads / s->level_then));
    const bte_real more = Z95 * root(variance), middle = s->kept[BTE_MEDIAN];
    const bte_real known = root(square(middle - s->kept[BTE_LOWER]) + square(more))
                           + root(square(s->kept[BTE_UPPER] - middle) + square(more));
    if (is_new || now[BTE_UPPER] - now[BTE_LOWER] <= known) {
        (void)memcpy(s->kept, now, sizeof s->kept);
        s->age = R(0.0);
        s->level_then = pads;
        variance = R(0.0);
    }
    s->age += block_time(s->car);
    const bte_real wider = Z95 * root(variance);
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        best[b] = s->kept[b];
    }
    widen(best, wider, wider);
}

/* The first reason that applies to a block with a pads' level. */
static bte_reason reason_of(const bte_state *s, const bte_block *x, bte_real level, bool of_map) {
    const bte_tuning *c = &s->car->tuning;
    bte_reason reason;
    if (x->pressure <= c->least_pressure) {
        reason = BTE_NOT_BRAKED;
    } else if (x->disturbed != BTE_VALID) {
        reason = x->disturbed;
    } else if (x->rim <= c->moving) {
        reason = BTE_SLOW;
    } else if (s->braked < c->settle - R(0.5) * block_time(s->car)) {
        reason = BTE_JUST_APPLIED;
    } else if (level <= c->least_level || level >= c->most_level) {
        reason = BTE_NO_PAD;
    } else if (!of_map) {
        reason = BTE_BEYOND_MAP;
    } else {
        reason = BTE_VALID;
    }
    return reason;
}

/* Share of the front axle in the brake force; ln of the ratio of what acts on the axles, besides. */
static bte_real front_share(const bte_car *car, bte_real log_ratio) {
    bte_real gain[BTE_AXLES];
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        gain[a] = car->torque_gain[a] * car->pad_friction[a] / car->radius[a];
    }
    return gain[BTE_FRONT] / (gain[BTE_FRONT] + gain[BTE_REAR] * exponential(-log_ratio));
}

/* Pad friction of both axles by level and ratio; distances to their bounds add up as squares. */
static void tell_pads(bte_state *s, bte_real log_odds, const bte_real level[BTE_BOUNDS],
                      const bte_real ratio[BTE_BOUNDS]) {
    const bte_car *car = s->car;
    const bte_real share = front_share(car, log_odds);
    bte_real part[BTE_AXLES][BTE_BOUNDS];
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        const bte_real rear = -logarithm(share * exponential(ratio[b]) + (R(1.0) - share));
        const unsigned other = b == BTE_MEDIAN ? b : 3U - b;
        part[BTE_FRONT][b] = ratio[b] + rear;
        part[BTE_REAR][other] = rear;
    }
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        const bte_real *x = part[a], middle = x[BTE_MEDIAN];
        bte_real sum[BTE_BOUNDS];
        for (unsigned b = 0; b < BTE_BOUNDS; b++) {
            sum[b] = level[b] + middle;
        }
        widen(sum, middle - x[BTE_LOWER], middle - x[BTE_UPPER]);
        for (unsigned b = 0; b < BTE_BOUNDS; b++) {
            s->pads[a][b] = car->pad_friction[a] * exponential(sum[b]);
        }
    }
}

void bte_take(bte_state *s, const bte_block *x) {
    const bte_car *car = s->car;
    const bte_tuning *c = &car->tuning;
    follow(s, x);
    const bte_real *p = s->speed, blocks = s->sums[0];
    const bool is_new = blocks == R(0.0);
    const bte_real z = is_new ? c->usual_z : s->mean_z;
    const bte_real mean_shift = s->sums[2] / (is_new ? R(1.0) : blocks), shift = mean_shift / z;
    bte_corners cell;
    const bte_real middle[3] = {z, shift, R(0.0)};
    corners(car, middle, &cell);
    const bte_real usual = car->slip_mean_step * weighed(car->slip_mean, cell.row, cell.weight);
    const bte_real sigma = car->slip_sigma_step * weighed(car->slip_sigma, cell.row, cell.weight);
    /* slip: one of what was measured and what the map has; what it was off, the scale of a_x was */
    const bte_real gain = R(1.0) / (p[SS] + square(sigma)), rest = usual - p[S];
    const bte_real slip = p[S] + gain * p[SS] * rest, slip_sigma = root(gain * p[SS]) * sigma;
    const bte_real scaled = largest(R(1.0) - p[E] - gain * p[SE] * rest, c->least_share);
    const bte_real scale_variance = largest(p[EE] - gain * square(p[SE]), R(0.0));
    /* level: friction as it is now, of the pressure as it is now */
    const bte_real steady = largest(s->level[0], c->least_share);
    const bte_real acts = x->pressure > c->bite ? s->acting / x->nominal : R(1.0);
    const bte_real pads = steady * clip(acts, c->least_share, R(1.0) / c->least_share);
    const bte_real noise = smallest(largest(s->level[3], R(0.0)) / square(steady), R(1.0));
    const bte_real accelerometer = s->demand.variance / square(z) + scale_variance;
    const bte_place at_z = BTE_FIND(&car->level_z, z);
    bte_real level[BTE_BOUNDS];
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        level[b] = on_line(car->level[b], car->level_step[b], at_z);
    }
    const bte_real wider = Z95 * root(noise + accelerometer);
    widen(level, wider, wider);
    const bte_real shown = logarithm(pads * scaled);
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        level[b] += shown;
    }
    /* ratio */
    const bte_real first = car->shift.x[0], last = car->shift.x[car->shift.count - 1U];
    const bool of_map = shift >= first && shift <= last;
    bte_real now[BTE_BOUNDS], prior[BTE_BOUNDS], unread = R(1.0);
    const bte_real at[3] = {z, shift, (slip - usual) / sigma};
    const bte_real error[2] = {eta_error(s, mean_shift, z, blocks) / z, slip_sigma / sigma};
    read_ratio(car, at, error, now);
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        prior[b] = on_line(car->before[b], car->before_step[b], at_z);
    }
    const bte_real read = (now[BTE_UPPER] - now[BTE_LOWER])
                          / (prior[BTE_UPPER] - prior[BTE_LOWER]);
    if (of_map && !is_new && z >= c->least_z && read < R(1.0)) {
        unread = read;
    } else {
        (void)memcpy(now, prior, sizeof now);
    }
    const bte_real moved = square(unread) * (x->log_odds - prior[BTE_MEDIAN] + car->ramp_ratio)
                           - x->log_odds;
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        now[b] += moved;
    }
    bte_real ratio[BTE_BOUNDS];
    keep_best(s, now, pads, is_new, ratio);
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        const bte_real file = car->pad_friction[BTE_FRONT] / car->pad_friction[BTE_REAR];
        s->level_told[b] = exponential(level[b]);
        s->ratio_told[b] = file * exponential(ratio[b]);
    }
    tell_pads(s, x->log_odds, level, ratio);
    s->reason = reason_of(s, x, s->level_told[BTE_MEDIAN], of_map);
}

void bte_told(const bte_state *s, bte_real p_mc, bte_output *out) {
    const bte_real pressed = largest(p_mc, R(0.0));
    out->reason = s->reason;
    (void)memcpy(out->level, s->level_told, sizeof out->level);
    (void)memcpy(out->ratio, s->ratio_told, sizeof out->ratio);
    (void)memcpy(out->pad_friction, s->pads, sizeof out->pad_friction);
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        for (unsigned b = 0; b < BTE_BOUNDS; b++) {
            out->brake_torque[a][b] = s->car->torque_gain[a] * pressed * s->pads[a][b];
        }
    }
    const bte_real both = R(2.0) * (out->brake_torque[BTE_FRONT][BTE_MEDIAN]
                                    + out->brake_torque[BTE_REAR][BTE_MEDIAN]);
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        out->brake_torque_sum[b] = s->level_told[b] / s->level_told[BTE_MEDIAN] * both;
    }
}

/* --- samples into blocks: calib/ecu/online.py ------------------------------------------------- */

static bool within(bte_real x, bte_real low, bte_real high) { return x >= low && x <= high; }

/* Slip of an axle at a normalised force. */
static bte_real slip_at(const bte_car *car, bte_real force) {
    const bte_place at = BTE_FIND(&car->tyre, size_of(force));
    const bte_real low = car->tyre_slip[at.at], high = car->tyre_slip[at.at + 1U];
    const bte_real slip = low + at.along * (high - low);
    return force < R(0.0) ? -slip : force > R(0.0) ? slip : R(0.0);
}

static bte_real median(bte_real a, bte_real b, bte_real c) {
    return largest(smallest(a, b), smallest(largest(a, b), c));
}

/* Take a reading: the last good one counts while it is out of its range, or jumps. */
static bool taken(const bte_state *s, bte_real x, bte_real low, bte_real high, bte_real jump,
                  bte_real *raw, bte_real *last) {
    const bool inside = within(x, low, high);
    const bool good = inside && !(s->started && size_of(x - *raw) > jump);
    *raw = inside ? x : *raw;
    *last = good ? x : *last;
    return good;
}

/* Take in a sample. Whether all sensors work. */
static bool good(bte_state *s, const bte_sample *x) {
    const bte_real any = R(1e9), dt = s->car->sample_time;
    bte_sample *raw = &s->raw, *last = &s->last;
    const bool same = s->started && x->a_x >= last->a_x && x->a_x <= last->a_x;
    bool fine = taken(s, x->p_mc, R(-1e6), R(4e7), R(1e7), &raw->p_mc, &last->p_mc);
    fine = taken(s, x->a_x, R(-30.0), R(30.0), R(15.0), &raw->a_x, &last->a_x) && fine;
    fine = taken(s, x->steering, R(-50.0), R(50.0), any, &raw->steering, &last->steering) && fine;
    fine = taken(s, x->driven, R(0.0), R(1.0), any, &raw->driven, &last->driven) && fine;
    for (unsigned w = 0; w < BTE_WHEELS; w++) {
        const bte_real jump = R(5.0) + R(5e3) * dt;
        fine = taken(s, x->omega[w], R(-50.0), R(500.0), jump, &raw->omega[w], &last->omega[w])
               && fine;
    }
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        fine = taken(s, x->drive[a], R(-2e4), R(2e4), any, &raw->drive[a], &last->drive[a]) && fine;
    }
    /* an accelerometer that does not move while the pressure does is frozen */
    const bte_real held_time = R(0.1), held_pressure = R(5e5);
    s->held = same ? s->held + dt : R(0.0);
    s->p_held = same ? s->p_held : last->p_mc;
    const bte_real rim = s->car->radius[BTE_FRONT] * last->omega[BTE_FL];
    return fine && !(s->held > held_time - R(0.5) * dt
                     && size_of(last->p_mc - s->p_held) > held_pressure
                     && rim > s->car->tuning.moving);
}

/* Whether the car is steered, corners, or a wheel locks, or just has. */
static bte_reason disturbance(bte_state *s, bool fine) {
    const bte_car *car = s->car;
    const bte_tuning *c = &car->tuning;
    const bte_sample *x = &s->last;
    bte_real fastest = R(0.0), slowest = R(0.0);
    for (unsigned w = 0; w < BTE_WHEELS; w++) {
        bte_real *b = s->before[w];
        const bte_real omega = s->started ? median(b[0], b[1], x->omega[w]) : x->omega[w];
        b[0] = s->started ? b[1] : x->omega[w];
        b[1] = x->omega[w];
        fastest = w == 0U ? omega : largest(fastest, omega);
        slowest = w == 0U ? omega : smallest(slowest, omega);
    }
    const bte_real mean = R(0.5) * (x->omega[BTE_RL] + x->omega[BTE_RR]);
    const bte_real speed = car->radius[BTE_REAR] * mean, z = -x->a_x / GRAVITY;
    s->fastest = largest(fastest, s->fastest - c->slows * car->sample_time);
    const bool locks = s->fastest - slowest > c->lock * largest(s->fastest, R(1.0))
                       && s->fastest > c->turning;
    s->since_lock = locks ? R(0.0) : s->since_lock + car->sample_time;
    const bte_real apart = (x->omega[BTE_RR] - x->omega[BTE_RL]) / largest(mean, R(1.0));
    const bte_real slip = largest(slip_at(car, z), R(0.0));
    const bte_real leaned = R(4.0) * slip * car->cg_height / (GRAVITY * car->track_width);
    const bte_real turned = apart / (car->track_width / square(largest(speed, c->moving)) + leaned);
    s->lateral = s->started ? s->lateral + car->lateral_part * (turned - s->lateral) : turned;
    bte_reason reason;
    if (!fine) {
        reason = BTE_FAULT;
    } else if (s->since_lock <= c->recover + R(0.5) * car->sample_time) {
        reason = BTE_LOCKED;
    } else if (!(size_of(s->lateral) < c->lateral)) {
        reason = BTE_CORNERS;
    } else if (!(size_of(x->steering) < c->steering)) {
        reason = BTE_TURNED;
    } else {
        reason = BTE_VALID;
    }
    return reason;
}

/* Slip of an axle besides that of a car which nothing but its brakes slows. */
static bte_real known_slip(const bte_car *car, bte_real tyre, bte_real other, bte_real load,
                           bte_real load_alone) {
    const bte_real least = R(0.1) * car->weight;
    return slip_at(car, (tyre + other) / largest(load, least))
           - slip_at(car, tyre / largest(load_alone, least));
}

/* A block from the sums: the force balance (1), (5) to (7), drag and rolling resistance known. */
static void take_block(bte_state *s) {
    const bte_car *car = s->car;
    const bte_real count = (bte_real)car->samples, dt = block_time(car);
    const bte_real p = s->sum_p / count, z = s->sum_z / count;
    bte_real omega[BTE_AXLES], spin[BTE_AXLES], load[BTE_AXLES], other[BTE_AXLES], nominal = R(0.0);
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        omega[a] = s->first[a] + s->sum_omega[a] / count;
        spin[a] = s->block_full ? (omega[a] - s->omega[a]) / dt : R(0.0);
        if (s->faulty || s->worst == BTE_FAULT) { /* of a reading that was held nothing is known */
            spin[a] = -GRAVITY * z / car->radius[a];
        }
        s->omega[a] = omega[a];
    }
    s->block_full = true;
    s->faulty = s->worst == BTE_FAULT;
    const bte_real speed = car->radius[BTE_REAR] * omega[BTE_REAR];
    const bte_real body = car->drag * square(speed), lifted = car->drag_lift * body;
    const bte_real grown = R(1.0) + car->rolling_growth * (square(speed / R(20.0)) - R(1.0));
    load[BTE_FRONT] = car->weight * (car->load_f + car->height * z);
    load[BTE_REAR] = car->weight * (car->load_r - car->height * z);
    bte_real demanded = car->weight * z - body, turning = R(1.0);
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        const bte_real mass = R(2.0) * car->inertia[a] / car->radius[a];
        other[a] = car->rolling * grown * load[a] - s->sum_drive[a] / count / car->radius[a];
        demanded -= other[a] + mass * spin[a];
        turning += mass / car->radius[a] * GRAVITY / car->weight;
        nominal += R(2.0) * car->torque_gain[a] * car->pad_friction[a] / car->radius[a] * p;
    }
    const bte_real alone = demanded / turning;
    const bte_real share = front_share(car, car->log_ratio);
    const bte_real part[BTE_AXLES] = {share, R(1.0) - share};
    const bte_real z_alone = alone / car->weight;
    const bte_real load_alone[BTE_AXLES] = {car->weight * (car->load_f + car->height * z_alone),
                                            car->weight * (car->load_r - car->height * z_alone)};
    load[BTE_FRONT] -= car->weight * lifted;
    load[BTE_REAR] += car->weight * lifted;
    bte_real driven[BTE_AXLES];
    for (unsigned a = 0; a < BTE_AXLES; a++) {
        const bte_real mass = R(2.0) * car->inertia[a] / square(car->radius[a]);
        const bte_real tyre = part[a] * demanded - mass * GRAVITY / car->weight * alone;
        driven[a] = known_slip(car, tyre, other[a], load[a], load_alone[a]);
    }
    const bte_real sums_apart = s->sum_omega[BTE_REAR] - s->sum_omega[BTE_FRONT];
    const bte_real apart = (s->first[BTE_REAR] - s->first[BTE_FRONT]) + sums_apart / count;
    const bte_real eta_less_1 = omega[BTE_FRONT] > R(0.0) ? apart / omega[BTE_FRONT] : R(0.0);
    const bte_real off = driven[BTE_REAR] - driven[BTE_FRONT];
    const bte_real left = eta_less_1 * (R(1.0) - driven[BTE_FRONT]) + off;
    bte_block block;
    block.demand = demanded / car->weight;
    block.nominal = nominal / car->weight;
    block.pressure = p;
    block.z = z;
    block.eta_less_1 = left / (R(1.0) - driven[BTE_REAR]);
    const bte_real slowest_rim = R(0.3);
    block.rim = largest(car->radius[BTE_FRONT] * omega[BTE_FRONT] / (R(1.0) - driven[BTE_FRONT]),
                        slowest_rim);
    block.rear_share = load[BTE_REAR] / car->weight;
    block.log_odds = R(0.0);
    block.disturbed = s->worst;
    block.driven = s->driven;
    bte_take(s, &block);
}

void bte_init(bte_state *s, const bte_car *car) {
    const bte_tuning *c = &car->tuning;
    (void)memset(s, 0, sizeof *s);
    s->car = car;
    s->demand.variance = square(c->zero);
    s->eta_less_1.value = car->radius[BTE_FRONT] / car->radius[BTE_REAR] - R(1.0);
    s->eta_less_1.variance = square(c->zero);
    s->level[1] = c->lag;
    s->level[6] = square(c->lag_sigma);
    s->level_then = R(1.0);
    s->since_lock = R(2.0) * c->recover;
    forget_stop(s);
    s->reason = BTE_NOT_BRAKED;
    const bte_real start[BTE_BOUNDS] = {R(1.0), c->least_level, c->most_level};
    for (unsigned b = 0; b < BTE_BOUNDS; b++) {
        s->level_told[b] = start[b];
        s->ratio_told[b] = start[b] * car->pad_friction[BTE_FRONT] / car->pad_friction[BTE_REAR];
        for (unsigned a = 0; a < BTE_AXLES; a++) {
            s->pads[a][b] = start[b] * car->pad_friction[a];
        }
    }
}

bool bte_exchange(bte_state *s, const bte_car *car) {
    bool rests = true;
    for (unsigned w = 0; w < BTE_WHEELS; w++) {
        rests = rests && size_of(s->last.omega[w]) < R(1.5);
    }
    if (rests) {
        bte_init(s, car);
    }
    return rests;
}

void bte_step(bte_state *s, const bte_sample *sample, bte_output *out) {
    const bte_car *car = s->car;
    const bool fine = good(s, sample);
    const bte_reason reason = disturbance(s, fine);
    const bte_sample *x = &s->last;
    s->started = true;
    s->worst = s->count == 0U || reason > s->worst ? reason : s->worst;
    s->driven = x->driven > R(0.5) || (s->count > 0U && s->driven);
    const bte_real omega[BTE_AXLES] = {R(0.5) * (x->omega[BTE_FL] + x->omega[BTE_FR]),
                                       R(0.5) * (x->omega[BTE_RL] + x->omega[BTE_RR])};
    if (s->count == 0U) {
        s->sum_p = R(0.0);
        s->sum_z = R(0.0);
    }
    s->sum_p += x->p_mc;
    s->sum_z -= x->a_x / GRAVITY;
    for (unsigned a = 0; a < BTE_AXLES; a++) { /* from the first one */
        s->first[a] = s->count == 0U ? omega[a] : s->first[a];
        s->sum_drive[a] = (s->count == 0U ? R(0.0) : s->sum_drive[a]) + x->drive[a];
        s->sum_omega[a] = s->count == 0U ? R(0.0) : s->sum_omega[a] + (omega[a] - s->first[a]);
    }
    s->count++;
    if (s->count >= car->samples) {
        s->count = 0;
        take_block(s);
    }
    bte_told(s, x->p_mc, out);
    out->reason = fine ? out->reason : BTE_FAULT;
}
