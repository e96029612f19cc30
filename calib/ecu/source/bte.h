/* Brake torque of each axle from wheel speeds, deceleration and pressure: brake-cal's estimator.
 *
 *     sample --means over a block--> zeros, level, lag, slip, ratio --> friction, torque, bounds
 *
 * SI units. No memory is allocated, nothing is recursive, and of math.h only sqrt, fabs, frexp and
 * ldexp are called, which have the same bits everywhere.
 * One task calls all functions of one `bte_state`:
 *
 *     bte_init(&state, &bte_this_car);                 at power-on, and after a reset
 *     bte_reason reason = bte_step(&state, x, y);      once every `sample_time` of the car
 */
#ifndef BTE_H
#define BTE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef $real bte_real;
typedef $cell bte_cell; /* of the maps */

/* Defined before this file: qualifiers of the calibration data, as `const volatile` where a tool
 * changes them, and what stands before their definitions, as an attribute with a section. */
#ifndef BTE_CAL
#define BTE_CAL const
#endif
#ifndef BTE_CAL_DATA
#define BTE_CAL_DATA
#endif

/* Why an answer does not hold. */
typedef enum {
$reasons
} bte_reason;

enum { BTE_FRONT, BTE_REAR, BTE_AXLES, BTE_WHEELS = 4, BTE_SIGNALS = 6 };

/* What the sensors read at one time, x[BTE_INPUTS]; bte_car.c has their ranges. */
enum {
$inputs
    BTE_INPUTS
};

/* What is answered, y[BTE_ANSWERS][BTE_BOUNDS]: medians with 95 % bounds, finite at any reason. */
enum { BTE_MEDIAN, BTE_LOWER, BTE_UPPER, BTE_BOUNDS };
enum {
$answers
    BTE_ANSWERS
};

/* Axes of maps: deceleration, (eta - 1)/z, slip in standard deviations; rising points. */
enum { BTE_Z, BTE_SHIFT, BTE_SLIP, BTE_MAP_AXES };
typedef struct {
    BTE_CAL bte_real *x;
    uint16_t count;
} bte_axis;

/* Columns over as many axes, linear between the points and held beyond their ends; cells times
 * `step` are the values. */
typedef struct {
    bte_axis axis[BTE_MAP_AXES];
    uint16_t axes, columns;
    BTE_CAL bte_cell *cells[BTE_BOUNDS];
    bte_real step[BTE_BOUNDS];
} bte_map;

/* The cell of an axis: its first point, and how far x is along it, from 0 to 1. */
typedef struct {
    uint16_t at;
    bte_real along;
} bte_place;

#ifdef BTE_FIND /* a search of your own; the last point has `along` 1 in the last cell */
bte_place BTE_FIND(const bte_axis *axis, bte_real x);
#endif

/* What a signal reads while nothing brakes, Kalman filters of brakes and speed, and their sums. */
$filters

/* Means over a block [SI], as the estimator takes them in; forces over the weight. */
typedef struct {
    bte_real demand, nominal, pressure, z, eta_less_1, rim, rear_share, disturbed;
} bte_block;

/* All that is remembered; of no use outside of bte.c, but for RAM that must survive a reset. */
typedef struct {
    const struct bte_car *car;
$state
    bool started, block_full, faulty, driven;
    uint32_t waits;
    bte_block waiting[3];
    bte_real last[BTE_INPUTS], raw[BTE_INPUTS], before[BTE_WHEELS][2];
    bte_real fastest, lateral, p_held, held, sum[BTE_SIGNALS], omega[BTE_AXLES];
    uint16_t count;
    bte_reason worst, reason;
    bte_real told[BTE_BRAKE_TORQUE_F][BTE_BOUNDS]; /* of the last block; torques follow */
} bte_state;

/* The numbers of a car, SI; calib/ecu/car_source.py of brake-cal has what they are. */
typedef struct bte_car {
    bte_state start;
    bte_map pads, slip, level, before;
    bte_axis tyre;
    BTE_CAL bte_real *tyre_slip, *version;
    uint16_t samples, waiting;
    bte_real $numbers;
} bte_car;

/* Forget everything. */
void bte_init(bte_state *state, const bte_car *car);

/* Take in a sample, and answer; the reason of the answer. */
bte_reason bte_step(bte_state *state, const bte_real x[BTE_INPUTS],
                    bte_real y[BTE_ANSWERS][BTE_BOUNDS]);

/* Take another car's numbers and forget everything: true at rest, false while it rolls. */
bool bte_exchange(bte_state *state, const bte_car *car);

/* The answer of the last block, with the torques at a pressure [Pa]. */
void bte_told(const bte_state *state, bte_real p_mc, bte_real y[BTE_ANSWERS][BTE_BOUNDS]);

extern const bte_car bte_this_car;

#ifdef __cplusplus
}
#endif

#endif
