/* A car that rolls and brakes in a straight line, as a model of fmu.h: the equations of
 * calib/model/solver.py with the numbers of bte_car.c, and the tyre of calib/car/magic_formula.py.
 * Newton's method finds the slips of the axles; z, speed and loads follow in the same turns.
 */
#include <math.h>

#include "bte.h"

static const double GRAVITY = 9.80665, LONGEST = 0.005, EDGE = 0.999, STOPS = 1.0;

/* Reasons, and the numbers that are given and told. */
enum { DRIVES, STANDS, LIFTS, SLIDES };
enum { P_MC, T_DRIVE, PADS = T_DRIVE + BTE_AXLES, STIFFNESS = PADS + BTE_AXLES, PEAK, SHAPE,
       LOAD_EXPONENT, V0 };
enum { A_X, WHEELS, SPEED = WHEELS + BTE_WHEELS, TORQUE };

typedef struct {
    double v, z, slip[BTE_AXLES], omega[BTE_AXLES];
    int32_t reason;
} model;

/* Normalised force at a slip, its slope, and the slip where the rising branch ends. */
typedef struct {
    double force, slope, end;
} grip;

static grip grip_at(const double given[], double slip, double relative_load) {
    const double soft = pow(relative_load, given[LOAD_EXPONENT]), shape = given[SHAPE];
    const double b = given[STIFFNESS] / (shape * given[PEAK]) / soft;
    const double end = tan(0.5 * acos(-1.0) * EDGE / shape) / b;
    const double held = fmin(fmax(slip, -end), end), angle = shape * atan(b * held);
    const double slope = given[STIFFNESS] / soft * cos(angle) / (1.0 + b * held * b * held);
    const grip found = {given[PEAK] * sin(angle) + (slip - held) * slope, slope, end};
    return found;
}

/* The state after `dt` [s], or that of a steady deceleration where it is 0. */
static void solve(model *m, const double given[], double dt) {
    const bte_car *car = &bte_this_car;
    const model was = *m;
    double change = 1.0;
    for (int turn = 0; turn < 100 && change > 1e-13; turn++) {
        m->v = was.v - 0.5 * GRAVITY * dt * (was.z + m->z);
        m->reason = m->v < STOPS ? STANDS : DRIVES;
        const double v = fmax(m->v, 0.5 * STOPS), drag = car->drag * v * v;
        const double rolling = car->rolling * (1.0 + car->rolling_growth * (v * v / 400.0 - 1.0));
        double sum = drag;
        change = 0.0;
        for (int a = 0; a < BTE_AXLES; a++) {
            const double share = car->load[a] + car->height[a] * m->z + car->drag_lift[a] * drag;
            const double load = car->weight * fmax(share, 0.01), radius = car->radius[a];
            const grip tyre = grip_at(given, m->slip[a], 2.0 * load / car->weight);
            const double turning = car->turning_mass[a], omega = v * (1.0 - m->slip[a]) / radius;
            const double steady = -GRAVITY * m->z * omega / v;
            const double spin = dt > 0.0 ? (omega - was.omega[a]) / dt : steady;
            const double brakes = 2.0 * given[PADS + a] * car->torque_gain[a] * given[P_MC];
            const double demanded = turning * radius * spin + rolling * load
                                    + (brakes - given[T_DRIVE + a]) / radius; /* (1) */
            const double slope = load * tyre.slope + (dt > 0.0 ? turning * v / dt : 0.0);
            const double more = (demanded - load * tyre.force) / slope;
            m->omega[a] = omega;
            m->slip[a] += more;
            m->reason = share < 0.01 ? LIFTS : fabs(m->slip[a]) > tyre.end ? SLIDES : m->reason;
            sum += load * (tyre.force + tyre.slope * more);
            change = fmax(change, fabs(more));
        }
        change = fmax(change, fabs(sum / car->weight - m->z));
        m->z = sum / car->weight; /* (5) */
    }
}

/* A car that stands is at rest; where it would lift or slide what was told last holds. */
static int32_t tell(const model *m, const double given[], double told[]) {
    const double moves = m->reason == DRIVES ? 1.0 : 0.0;
    if (m->reason <= STANDS) {
        told[A_X] = -GRAVITY * m->z * moves;
        told[SPEED] = m->v * moves;
        for (int w = 0; w < BTE_WHEELS; w++) {
            told[WHEELS + w] = m->omega[w / 2] * moves;
        }
        for (int a = 0; a < BTE_AXLES; a++) {
            told[TORQUE + a] = given[PADS + a] * bte_this_car.torque_gain[a] * given[P_MC];
        }
    }
    return m->reason;
}

static int32_t model_start(model *m, const double given[], double told[]) {
    memset(m, 0, sizeof *m);
    m->v = given[V0];
    solve(m, given, 0.0);
    return tell(m, given, told);
}

static int32_t model_step(model *m, const double given[], double told[]) {
    const int parts = (int)ceil(FMU_SAMPLE_TIME / LONGEST - 1e-6);
    for (int i = 0; i < parts && m->reason == DRIVES; i++) {
        solve(m, given, FMU_SAMPLE_TIME / parts);
    }
    return tell(m, given, told);
}
