/* A car that rolls and brakes in a straight line, as a model of fmi.c: the equations of
 * calib/model/solver.py with the numbers of the car, and the tyre of calib/car/magic_formula.py.
 * Forces are over the weight of the car. Newton's method finds the slips of the axles; z, speed and
 * loads follow in the same iterations.
 */
static const double G = 9.80665;  /* [m/s^2] */
static const double EDGE = 0.999; /* share of the rising branch of the tyre formula that is used */
static const double STOPS = 1.0;  /* speed at which the car stops [m/s] */
static const double LEAST = 0.01; /* load of an axle over the weight at which it lifts */
enum { DRIVES, STANDS, LIFTS, SLIDES }; /* reasons */
enum { ITERATIONS = 40 };

typedef struct {
    double v, z, slip[BTE_AXLES], omega[BTE_AXLES];
} model;

/* Find the state after `dt` [s]; where `dt` is 0, that of a steady deceleration. */
static void solve(model *m, double x[], double dt) {
    const bte_numbers *car = {{ data }}.numbers;
    const double shape = x[TYRE_SHAPE], edge = tan(0.5 * acos(-1.0) * EDGE / shape);
    const model last = *m;
    m->slip[BTE_FRONT] = m->slip[BTE_REAR] = 0.0; /* from there no iteration passes a peak */
    for (int i = 0; i < ITERATIONS; i++) {
        m->v = last.v - 0.5 * G * dt * (last.z + m->z);
        x[REASON] = m->v < STOPS ? STANDS : DRIVES;
        const double v = fmax(m->v, 0.5 * STOPS), drag = car->drag * v * v;
        const double rolling = car->rolling + car->rolling_growth * v * v;
        double sum = drag;
        for (int a = 0; a < BTE_AXLES; a++) {
            const double share = car->load[a] + car->height[a] * m->z + car->drag_lift[a] * drag;
            const double load = fmax(share, LEAST);
            /* tyre: peak sin(C atan(B x)), and straight on from the edge; rise: d force/d slip */
            const double by_load = pow(2.0 * load, x[TYRE_LOAD_EXPONENT]);
            const double stiffness = load * x[TYRE_STIFFNESS] / by_load, peak = load * x[TYRE_PEAK];
            const double bx = stiffness / (shape * peak) * m->slip[a];
            const double clipped = fmin(fmax(bx, -edge), edge), angle = shape * atan(clipped);
            const double rise = stiffness * cos(angle) / (1.0 + clipped * clipped);
            const double force = peak * (sin(angle) + shape * (bx - clipped) * rise / stiffness);
            /* wheels and brakes */
            const double radius = car->rolling_radius[a], turning = car->spinning[a];
            const double omega = v * (1.0 - m->slip[a]) / radius;
            const double spin = dt > 0.0 ? (omega - last.omega[a]) / dt : -G * m->z * omega / v;
            const double brakes = 2.0 * x[PAD_FRICTION_F + a] * car->torque_gain[a] * x[P_MC];
            const double demanded = turning * spin + rolling * load
                                    + (brakes - x[T_DRIVE_F + a]) * car->drive[a]; /* (1) */
            const double by_spin = dt > 0.0 ? turning * v / (radius * dt) : 0.0;
            const double step = (demanded - force) / (rise + by_spin); /* of Newton's method */
            m->omega[a] = omega;
            m->slip[a] += step;
            if (share < LEAST) {
                x[REASON] = LIFTS;
            } else if (fabs(bx) > edge) {
                x[REASON] = SLIDES;
            }
            sum += force + rise * step;
        }
        m->z = sum; /* (5) */
    }
}

/* A car that stands is at rest; where it would lift or slide the last values stay. */
static void model_step(model *m, double x[], bool first) {
    if (first) {
        *m = (model){.v = x[V0]};
        x[REASON] = DRIVES;
    }
    if (x[REASON] == DRIVES) {
        solve(m, x, first ? 0.0 : SAMPLE_TIME);
    }
    if (x[REASON] <= STANDS) {
        const double moves = x[REASON] == DRIVES ? 1.0 : 0.0;
        x[A_X] = -G * m->z * moves;
        x[V] = m->v * moves;
        for (int a = 0; a < BTE_AXLES; a++) {
            x[OMEGA_FL + 2 * a] = x[OMEGA_FR + 2 * a] = m->omega[a] * moves;
            const double gain = {{ data }}.numbers->torque_gain[a];
            x[BRAKE_TORQUE_FL + 2 * a] = gain * x[PAD_FRICTION_F + a] * x[P_MC];
            x[BRAKE_TORQUE_FR + 2 * a] = x[BRAKE_TORQUE_FL + 2 * a];
        }
    }
}
